/* What a board gives to the node: bytes in, bytes out, the time. Everything else of the port is the same for all. */
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

/* For laconic_node_config.nonce_seed: other at each power-up; 0 where the board has nothing that is. */
uint32_t board_nonce_seed(void);

/* Called by the board's interrupt, room first: an interrupt that was pending already comes once more after it has been
 * switched off, and a byte that it took then would overwrite one that waits. No room: leave the byte where it is and
 * switch the interrupt off until board_resume. */
bool port_has_room(void);
void port_received(char byte);
void board_resume(void);

#define NVIC_ENABLE REGISTER(0xE000E100U)

#endif
