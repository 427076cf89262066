/* BBC micro:bit (nRF51822, Cortex-M0): UART0 over the USB interface chip, TIMER0 at 1 MHz. */
#include "board.h"

#define UART_START_RX REGISTER(0x40002000U)
#define UART_START_TX REGISTER(0x40002008U)
#define UART_RX_READY REGISTER(0x40002108U)
#define UART_TX_READY REGISTER(0x4000211CU)
#define UART_INTERRUPT_SET REGISTER(0x40002304U)
#define UART_INTERRUPT_CLEAR REGISTER(0x40002308U)
#define UART_ENABLE REGISTER(0x40002500U)
#define UART_PIN_TX REGISTER(0x4000250CU)
#define UART_PIN_RX REGISTER(0x40002514U)
#define UART_RX REGISTER(0x40002518U)
#define UART_TX REGISTER(0x4000251CU)
#define UART_BAUD REGISTER(0x40002524U)
enum { UART_IRQ = 2, WAKE_IRQ = 8 };
enum { UART_ON = 4, RX_INTERRUPT = 1 << 2, PIN_TX = 24, PIN_RX = 25 };
#define BAUD_115200 0x01D7E000U

#define TIMER_START REGISTER(0x40008000U)
#define TIMER_CAPTURE_0 REGISTER(0x40008040U)
#define TIMER_EVENT_1 REGISTER(0x40008144U)
#define TIMER_INTERRUPT_SET REGISTER(0x40008304U)
#define TIMER_BITS REGISTER(0x40008508U)
#define TIMER_PRESCALER REGISTER(0x40008510U)
#define TIMER_COMPARE_0 REGISTER(0x40008540U)
#define TIMER_COMPARE_1 REGISTER(0x40008544U)
enum { BITS_32 = 3, ONE_MHZ = 4, COMPARE_1_INTERRUPT = 1 << 17, WAKE_US = 1000 };

#define NOISE_START REGISTER(0x4000D000U)
#define NOISE_STOP REGISTER(0x4000D004U)
#define NOISE_READY REGISTER(0x4000D100U)
#define NOISE_VALUE REGISTER(0x4000D508U)

static bool sending;

void board_init(void) {
    TIMER_BITS = BITS_32;
    TIMER_PRESCALER = ONE_MHZ;
    TIMER_COMPARE_1 = WAKE_US;
    TIMER_INTERRUPT_SET = COMPARE_1_INTERRUPT;
    TIMER_START = 1;
    UART_PIN_TX = PIN_TX;
    UART_PIN_RX = PIN_RX;
    UART_BAUD = BAUD_115200;
    UART_ENABLE = UART_ON;
    UART_START_TX = 1;
    UART_START_RX = 1;
    UART_INTERRUPT_SET = RX_INTERRUPT;
    NVIC_ENABLE = 1U << UART_IRQ | 1U << WAKE_IRQ;
}

bool board_send(char byte) {
    if (sending && UART_TX_READY == 0) return false;
    UART_TX_READY = 0;
    UART_TX = (uint8_t)byte;
    sending = true;
    return true;
}

uint32_t board_now_us(void) {
    TIMER_CAPTURE_0 = 1;
    return TIMER_COMPARE_0;
}

/* Four bytes of the random number generator: thermal noise, about 0.7 ms each. */
uint32_t board_nonce_seed(void) {
    uint32_t seed = 0;
    NOISE_START = 1;
    for (int k = 0; k < 4; k++) {
        while (NOISE_READY == 0) {
        }
        NOISE_READY = 0;
        seed = seed << 8 | (NOISE_VALUE & 255U);
    }
    NOISE_STOP = 1;
    return seed;
}

void board_resume(void) { UART_INTERRUPT_SET = RX_INTERRUPT; }

static void uart_handler(void) {
    if (UART_RX_READY == 0) return;
    if (port_has_room()) {
        UART_RX_READY = 0;
        port_received((char)UART_RX);
    } else {
        UART_INTERRUPT_CLEAR = RX_INTERRUPT;
    }
}

/* A compare value that is already past would match 71 minutes later, so it is set again until it lies in the future. */
static void wake_handler(void) {
    uint32_t wake_us;
    TIMER_EVENT_1 = 0;
    do {
        wake_us = board_now_us() + WAKE_US;
        TIMER_COMPARE_1 = wake_us;
    } while ((int32_t)(board_now_us() - wake_us) >= 0);
}

BOARD_INTERRUPTS = {[UART_IRQ] = uart_handler, [WAKE_IRQ] = wake_handler};
