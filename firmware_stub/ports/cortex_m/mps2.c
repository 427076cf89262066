/* Arm MPS2 with AN385 (M3), AN386 (M4F), AN500 (M7): CMSDK UART0, TIMER0 and TIMER1 at 25 MHz. */
#include "board.h"

#define UART_DATA REGISTER(0x40004000U)
#define UART_STATE REGISTER(0x40004004U)
#define UART_CONTROL REGISTER(0x40004008U)
#define UART_INTERRUPT REGISTER(0x4000400CU)
#define UART_DIVIDER REGISTER(0x40004010U)
enum { UART_IRQ = 0, WAKE_IRQ = 9 };
enum { TX_FULL = 1, RX_FULL = 2, TX_ENABLE = 1, RX_ENABLE = 2, RX_INTERRUPT = 8, RX_CLEAR = 2 };

#define CLOCK_CONTROL REGISTER(0x40000000U)
#define CLOCK_VALUE REGISTER(0x40000004U)
#define CLOCK_RELOAD REGISTER(0x40000008U)
#define WAKE_CONTROL REGISTER(0x40001000U)
#define WAKE_RELOAD REGISTER(0x40001008U)
#define WAKE_INTERRUPT REGISTER(0x4000100CU)
enum { TIMER_ENABLE = 1, TIMER_INTERRUPT = 8 };

#define TICKS_PER_US 25U
#define BAUD 115200U

static uint32_t last_value;
static uint32_t odd_ticks;
static uint32_t time_us;

void board_init(void) {
    CLOCK_RELOAD = UINT32_MAX;
    CLOCK_CONTROL = TIMER_ENABLE;
    last_value = CLOCK_VALUE;
    WAKE_RELOAD = 1000U * TICKS_PER_US - 1U;
    WAKE_CONTROL = TIMER_ENABLE | TIMER_INTERRUPT;
    UART_DIVIDER = 1000000U * TICKS_PER_US / BAUD;
    UART_CONTROL = TX_ENABLE | RX_ENABLE | RX_INTERRUPT;
    NVIC_ENABLE = 1U << UART_IRQ | 1U << WAKE_IRQ;
}

bool board_send(char byte) {
    if (UART_STATE & TX_FULL) return false;
    UART_DATA = (uint8_t)byte;
    return true;
}

/* The hardware counter runs down from 2^32 − 1. Ticks that make no whole microsecond are kept for the next call. */
uint32_t board_now_us(void) {
    const uint32_t value = CLOCK_VALUE;
    const uint32_t ticks = last_value - value + odd_ticks;
    last_value = value;
    time_us += ticks / TICKS_PER_US;
    odd_ticks = ticks % TICKS_PER_US;
    return time_us;
}

/* The MPS2 has neither a random number generator nor a battery clock: only the instant of the first HELLO differs. */
uint32_t board_nonce_seed(void) { return 0; }

static void uart_handler(void) {
    UART_INTERRUPT = RX_CLEAR;
    if ((UART_STATE & RX_FULL) == 0) return;
    if (port_has_room()) {
        port_received((char)UART_DATA);
    } else {
        UART_CONTROL = TX_ENABLE | RX_ENABLE;
    }
}

/* A byte that came while the interrupt was disabled has raised none, so it is fetched here. */
void board_resume(void) {
    __asm volatile("cpsid i" ::: "memory");
    UART_CONTROL = TX_ENABLE | RX_ENABLE | RX_INTERRUPT;
    uart_handler();
    __asm volatile("cpsie i" ::: "memory");
}

static void wake_handler(void) { WAKE_INTERRUPT = 1; }

BOARD_INTERRUPTS = {[UART_IRQ] = uart_handler, [WAKE_IRQ] = wake_handler};
