/* The node on a board: SLCAN on its UART.
 *
 * The receive interrupt puts one byte into a ring; all other work is done here, and the processor sleeps in between.
 * When the ring is full the interrupt is switched off until there is room, so no interrupt ever waits. */
#include "board.h"
#include "laconic_node/node.h"
#include "laconic_node/slcan.h"
#include "laconic_wire.h"
#include "linked.h"
#include "watch.h"

#define RING_SIZE 256U /* 11 classic frames; a power of two */

static laconic_node node;
static laconic_slcan slcan;
static volatile char ring[RING_SIZE];
static volatile uint16_t ring_head, ring_tail; /* written by the interrupt; by main */
static volatile bool ring_was_full;
static char line[LACONIC_SLCAN_LINE];
static uint16_t line_length, line_sent;
static uint8_t frames_to_confirm; /* lines of frames whose CR has not been sent                   */
static bool reply_waits;          /* to be sent behind these; no byte is read before, nor is one lost */

bool port_has_room(void) {
    if ((uint16_t)(ring_head - ring_tail) < RING_SIZE) return true;
    ring_was_full = true;
    return false;
}

void port_received(char byte) {
    const uint16_t head = ring_head;
    ring[head % RING_SIZE] = byte;
    ring_head = (uint16_t)(head + 1U);
}

static bool take_byte(char *byte) {
    const uint16_t tail = ring_tail;
    if (tail == ring_head) return false;
    *byte = ring[tail % RING_SIZE];
    ring_tail = (uint16_t)(tail + 1U);
    if (ring_was_full) {
        ring_was_full = false;
        board_resume();
    }
    return true;
}

/* Where no other line is queued. */
static void queue_reply(const char *text) {
    while (text[line_length] != 0) {
        line[line_length] = text[line_length];
        line_length++;
    }
}

/* Sends one line at a time and fetches the next frame when the line is sent; true: there may be more to send. It is not
 * inlined: its frame would take room on the stack below each step. */
static bool __attribute__((noinline)) send_some(void) {
    laconic_frame frame;
    if (line_sent == line_length) {
        line_sent = 0;
        line_length = 0;
        if (frames_to_confirm > 0) {
            frames_to_confirm--;
            line[line_length++] = '\r';
        } else if (reply_waits) {
            reply_waits = false;
            queue_reply(slcan.reply);
        } else if (port_next_frame(&node, &frame)) {
            line_length = (uint16_t)laconic_slcan_write(&slcan, &frame, line);
        }
    }
    while (line_sent < line_length && board_send(line[line_sent])) line_sent++;
    return line_length > 0;
}

/* Steps that are due, of drives also the next period, which may be shorter than the interval of the wake-up. */
static bool has_steps(void) {
    if (LACONIC_NODE_WITH_DRIVES) return laconic_node_idle_us(&node, board_now_us()) == 0;
    return laconic_node_is_busy(&node);
}

static bool receive_some(void) {
    laconic_frame frame;
    char byte;
    while (!reply_waits && take_byte(&byte)) {
        switch (laconic_slcan_feed(&slcan, byte, &frame)) {
        case LACONIC_SLCAN_FRAME:
            frames_to_confirm++; /* a few at most: they go out before the next line */
            port_on_frame(&node, &frame, board_now_us());
            return true;
        case LACONIC_SLCAN_REPLY: reply_waits = true; return true;
        default: break;
        }
    }
    return false;
}

/* WFI also wakes for a masked interrupt, so a byte that comes between the test and WFI ends the sleep. */
static void sleep_until_interrupt(void) {
    __asm volatile("cpsid i" ::: "memory");
    if (ring_head == ring_tail) __asm volatile("wfi");
    __asm volatile("cpsie i" ::: "memory");
}

#define RESET_CONTROL REGISTER(0xE000ED0CU)
#define RESET_REQUEST 0x05FA0004U

/* A fault restarts the board: the rig then finds the state EMPTY and reports it. */
void board_fault(void) {
    RESET_CONTROL = RESET_REQUEST;
    for (;;) {
    }
}

void board_end(int status) {
    (void)status; /* main does not return */
    board_fault();
}

/* In a function of its own, so that its numbers take no room on the stack afterwards. */
static void begin(void) {
    laconic_node_config config = {.id_base = LACONIC_WIRE_ID_BASE,
                                  .can_fd = LACONIC_NODE_CAN_FD != 0,
                                  .method = port_method,
                                  .nonce_seed = board_nonce_seed()};
    port_add_protocols(&config);
    laconic_slcan_init(&slcan, 0);
    if (!laconic_node_init(&node, &config, board_now_us())) board_end(1);
    port_watch(&node);
}

int main(void) {
    board_init();
    begin();
    for (;;) {
        const bool is_busy = receive_some();
        port_on_tick(&node, board_now_us());
        const bool sending = send_some();
        if (!is_busy && !sending && node.pending == 0 && !has_steps()) sleep_until_interrupt();
    }
}
