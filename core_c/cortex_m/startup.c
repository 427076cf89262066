/* From reset to main, for ARMv6-M, ARMv7-M and ARMv7E-M. The linker script names the borders of the sections. */
#include "startup.h"

extern uint32_t board_stack_top;
extern uint32_t board_data_load, board_data_start, board_data_end, board_bss_start, board_bss_end;

int main(void);
void board_reset(void);

#define COPROCESSOR_ACCESS REGISTER(0xE000ED88U)

typedef union vector {
    uint32_t *stack;
    void (*handler)(void);
} vector;

__attribute__((section(".vectors"), used)) static const vector vectors[16] = {
    {.stack = &board_stack_top}, {.handler = board_reset}, {.handler = board_fault}, {.handler = board_fault},
    {.handler = board_fault},    {.handler = board_fault}, {.handler = board_fault},
};

void board_reset(void) {
    const uint32_t *from = &board_data_load;
    for (uint32_t *to = &board_data_start; to < &board_data_end; to++) *to = *from++;
    for (uint32_t *to = &board_bss_start; to < &board_bss_end; to++) *to = 0;
#if defined(__ARM_FP)
    COPROCESSOR_ACCESS |= 0xFU << 20; /* CP10, CP11: full access, before the first FPU instruction */
    __asm volatile("dsb\n isb");
#endif
    board_end(main());
}
