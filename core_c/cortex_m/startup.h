/* The interface between startup.c and an image for a Cortex-M board: two functions that end it, and its interrupts. */
#ifndef LACONIC_STARTUP_H
#define LACONIC_STARTUP_H

#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))

/* The image provides both; neither returns. */
void board_end(int status) __attribute__((noreturn)); /* main has returned `status` */
void board_fault(void) __attribute__((noreturn));     /* a fault exception has occurred */

/* Declares the handlers of the processor's own interrupts: `BOARD_INTERRUPTS = {[number] = handler, …};`, once in an
 * image. The linker script puts them after the sixteen vectors of every Cortex-M. */
#define BOARD_INTERRUPTS __attribute__((section(".interrupts"), used)) static void (*const board_interrupts[])(void)

#endif
