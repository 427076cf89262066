/* The functions of a board for bench images: text, an end and a clock that counts instructions.
 *
 * Text and end go through ARM semihosting, so no board needs a UART driver. The clock is SysTick on the
 * processor clock; under `qemu-system-arm -icount shift=8` every instruction lasts 256 ns, so ticks are
 * instructions times a constant that board_calibrate() measures. The counter has 24 bits. */
#ifndef BENCH_BOARD_H
#define BENCH_BOARD_H

#include "startup.h"

void board_write(const char *text);

void board_write_number(const char *name, uint64_t value);
void board_write_bits(const char *name, const void *bytes, uint32_t size);

void board_clock_start(void);
uint32_t board_clock_now(void);
uint32_t board_clock_since(uint32_t earlier); /* ticks, up to 2^24 − 1 */
uint32_t board_calibrate(void);               /* ticks that 65,536 instructions take */

uint32_t board_stack_of(void (*work)(void)); /* bytes of stack below the call, found by painting 4 KB of it */

#endif
