/* Start of a Cortex-M bench image: vector table, memory set-up, FPU, and the way out.
 *
 * One file for ARMv6-M, ARMv7-M and ARMv7E-M. The linker script names the borders of the sections. */
#include "board.h"

extern uint32_t board_stack_top;
extern uint32_t board_data_load, board_data_start, board_data_end, board_bss_start, board_bss_end;

int main(void);
void board_reset(void);
static void board_fault(void);

#define COPROCESSOR_ACCESS (*(volatile uint32_t *)0xE000ED88U)

typedef union vector {
    uint32_t *stack;
    void (*handler)(void);
} vector;

__attribute__((section(".vectors"), used)) static const vector vectors[16] = {
    {.stack = &board_stack_top}, {.handler = board_reset}, {.handler = board_fault}, {.handler = board_fault},
    {.handler = board_fault},    {.handler = board_fault}, {.handler = board_fault},
};

static void board_fault(void) {
    board_write("fault\n");
    board_exit(1);
}

void board_reset(void) {
    const uint32_t *from = &board_data_load;
    for (uint32_t *to = &board_data_start; to < &board_data_end; to++) *to = *from++;
    for (uint32_t *to = &board_bss_start; to < &board_bss_end; to++) *to = 0;
#if defined(__ARM_FP)
    COPROCESSOR_ACCESS |= 0xFU << 20; /* CP10, CP11: full access, before the first FPU instruction */
    __asm volatile("dsb\n isb");
#endif
    board_exit(main());
}
