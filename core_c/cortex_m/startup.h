/* What an image for a Cortex-M board shares with startup.c: its two ends, and what it may add to the vector table. */
#ifndef LACONIC_STARTUP_H
#define LACONIC_STARTUP_H

#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))

/* The image provides both; neither returns. */
void board_end(int status) __attribute__((noreturn)); /* main has returned `status` */
void board_fault(void) __attribute__((noreturn));     /* the processor has met a fault */

/* Declares the handlers of the processor's own interrupts: `BOARD_INTERRUPTS = {[number] = handler, …};`, once in an
 * image. The linker script puts them behind the sixteen vectors that every processor has. */
#define BOARD_INTERRUPTS __attribute__((section(".interrupts"), used)) static void (*const board_interrupts[])(void)

#endif
