/* The functions of a board: receive and send bytes, the time. The rest of the port is the same for all boards. */
#ifndef BOARD_H
#define BOARD_H

#include "startup.h"

#include <stdbool.h>

/* UART at 115200 baud with receive interrupt, a microsecond timer, and a wake-up interrupt every millisecond. */
void board_init(void);

/* Sends a byte if the UART takes one at once; false iff it does not. Never waits. */
bool board_send(char byte);

/* Microseconds since start; wraps. To be called at least every two minutes. */
uint32_t board_now_us(void);

/* For laconic_node_config.nonce_seed: different at each power-up; 0 if the board has no source for that. */
uint32_t board_nonce_seed(void);

/* The board's receive interrupt calls port_has_room first, each time: one that is already pending still runs after the
 * interrupt is disabled, and its byte would overwrite one in the ring. Without room the interrupt leaves the byte in
 * the UART and disables itself until board_resume. */
bool port_has_room(void);
void port_received(char byte);
void board_resume(void);

#define NVIC_ENABLE REGISTER(0xE000E100U)

#endif
