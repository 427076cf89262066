/* Text, end, instruction counter and stack gauge of a bench image. */
#include "bench_board.h"

enum { SEMIHOSTING_WRITE0 = 0x04, SEMIHOSTING_EXIT = 0x18, SEMIHOSTING_EXIT_EXTENDED = 0x20 };
#define APPLICATION_EXIT 0x20026U

#define SYSTICK_CONTROL REGISTER(0xE000E010U)
#define SYSTICK_RELOAD REGISTER(0xE000E014U)
#define SYSTICK_VALUE REGISTER(0xE000E018U)
#define SYSTICK_LARGEST 0xFFFFFFU

static void semihosting(uint32_t operation, const void *argument) {
    register uint32_t r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = argument;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

void board_write(const char *text) { semihosting(SEMIHOSTING_WRITE0, text); }

void board_end(int status) {
    const uint32_t block[2] = {APPLICATION_EXIT, (uint32_t)status};
    semihosting(SEMIHOSTING_EXIT_EXTENDED, block);
    for (;;) {
    }
}

void board_fault(void) {
    board_write("fault\n");
    board_end(1);
}

void board_write_number(const char *name, uint64_t value) {
    char text[24];
    char *end = text + sizeof text;
    *--end = 0;
    *--end = '\n';
    do {
        *--end = (char)('0' + (int)(value % 10U));
        value /= 10U;
    } while (value != 0);
    board_write(name);
    board_write(" ");
    board_write(end);
}

/* Most significant byte first, so that the text reads as one hexadecimal number (the boards are little-endian). */
void board_write_bits(const char *name, const void *bytes, uint32_t size) {
    static const char digits[] = "0123456789abcdef";
    const uint8_t *from = (const uint8_t *)bytes + size;
    board_write(name);
    board_write(" ");
    while (size-- > 0) {
        const uint8_t byte = *--from;
        const char pair[3] = {digits[byte >> 4], digits[byte & 15U], 0};
        board_write(pair);
    }
    board_write("\n");
}

void board_clock_start(void) {
    SYSTICK_CONTROL = 0;
    SYSTICK_RELOAD = SYSTICK_LARGEST;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 5; /* enabled, no interrupt, processor clock */
}

uint32_t board_clock_now(void) { return SYSTICK_LARGEST - SYSTICK_VALUE; }

uint32_t board_clock_since(uint32_t earlier) { return (board_clock_now() - earlier) & SYSTICK_LARGEST; }

uint32_t board_calibrate(void) {
    uint32_t rounds = 32768U; /* of two instructions */
    board_clock_start();
    const uint32_t before = board_clock_now();
    __asm volatile(".syntax unified\n1: subs %0, %0, #1\n bne 1b" : "+l"(rounds) : : "cc");
    return board_clock_since(before);
}

enum { PAINTED_WORDS = 1024, SPARED_WORDS = 32 };
#define PAINT 0xA5C3E1F7U

uint32_t board_stack_of(void (*work)(void)) {
    volatile uint32_t *here = __builtin_frame_address(0);
    volatile uint32_t *top = here - SPARED_WORDS, *bottom = top - PAINTED_WORDS;
    uint32_t stack_pointer;
    for (volatile uint32_t *word = bottom; word < top; word++) *word = PAINT;
    __asm volatile("mov %0, sp" : "=r"(stack_pointer));
    work();
    while (bottom < top && *bottom == PAINT) bottom++;
    return stack_pointer - (uint32_t)(uintptr_t)bottom;
}
