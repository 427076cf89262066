/* From reset to main, for ARMv6-M, ARMv7-M and ARMv7E-M. The linker script names the borders of the sections. */
#include "board.h"

extern uint32_t board_stack_top;
extern uint32_t board_data_load, board_data_start, board_data_end, board_bss_start, board_bss_end;

int main(void);
void board_reset(void);
static void halt(void);

#define COPROCESSOR_ACCESS REGISTER(0xE000ED88U)
#define RESET_CONTROL REGISTER(0xE000ED0CU)
#define RESET_REQUEST 0x05FA0004U

typedef union vector {
    uint32_t *stack;
    void (*handler)(void);
} vector;

/* The table serves all boards: each uses two interrupts of its own, the others are never enabled. */
__attribute__((section(".vectors"), used)) static const vector vectors[16 + 10] = {
    [0] = {.stack = &board_stack_top},
    [1] = {.handler = board_reset},
    [2] = {.handler = halt},
    [3] = {.handler = halt},
    [4] = {.handler = halt},
    [5] = {.handler = halt},
    [6] = {.handler = halt},
#ifdef BOARD_MICROBIT
    [16 + BOARD_UART_IRQ_MICROBIT] = {.handler = board_uart_handler},
    [16 + BOARD_WAKE_IRQ_MICROBIT] = {.handler = board_wake_handler},
#else
    [16 + BOARD_UART_IRQ_MPS2] = {.handler = board_uart_handler},
    [16 + BOARD_WAKE_IRQ_MPS2] = {.handler = board_wake_handler},
#endif
};

/* A fault restarts the board: the rig sees the state "empty" and says so. */
static void halt(void) {
    RESET_CONTROL = RESET_REQUEST;
    for (;;) {
    }
}

void board_reset(void) {
    const uint32_t *from = &board_data_load;
    for (uint32_t *to = &board_data_start; to < &board_data_end; to++) *to = *from++;
    for (uint32_t *to = &board_bss_start; to < &board_bss_end; to++) *to = 0;
#if defined(__ARM_FP)
    COPROCESSOR_ACCESS |= 0xFU << 20; /* CP10, CP11: full access, before the first FPU instruction */
    __asm volatile("dsb\n isb");
#endif
    main();
    halt();
}
