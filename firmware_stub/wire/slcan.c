/* Parses lines of SLCAN as frames and commands, and writes frames as lines. */
#include "laconic_node/slcan.h"

/* Lengths of frames by their DLC, which in classic CAN is the length. */
static const uint8_t fd_lengths[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};

static uint8_t length_of(uint32_t dlc) { return LACONIC_NODE_CAN_FD ? fd_lengths[dlc] : (uint8_t)dlc; }

static uint32_t dlc_of(uint8_t length) {
    uint32_t dlc = 0;
    while (dlc < 15U && length_of(dlc) < length) dlc++;
    return LACONIC_NODE_CAN_FD ? dlc : length;
}

static int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return -1;
}

/* Reads `count` hexadecimal digits; false iff one is none. */
static bool number(const char *text, size_t count, uint32_t *value) {
    *value = 0;
    for (size_t k = 0; k < count; k++) {
        const int d = digit(text[k]);
        if (d < 0) return false;
        *value = (*value << 4) | (uint32_t)d;
    }
    return true;
}

void LACONIC_SLCAN_BUILT(void) {}

void(laconic_slcan_init)(laconic_slcan *slcan, char required_rate) {
    slcan->open = false;
    slcan->listen_only = false;
    slcan->required_rate = required_rate;
    slcan->rate_is_wrong = false;
    slcan->length = 0;
    slcan->reply[0] = 0;
}

/* Capital letters are for 29-bit identifiers. */
static bool kind_of(char letter, laconic_frame *frame) {
    const char kind = (char)(letter | ' ');
    frame->extended = kind != letter;
    frame->remote = kind == 'r';
    frame->bit_rate_switch = LACONIC_NODE_CAN_FD && kind == 'b';
    frame->fd = LACONIC_NODE_CAN_FD && (kind == 'd' || kind == 'b');
    return kind == 't' || frame->remote || frame->fd;
}

/* The line must have exactly the length that its DLC states. */
static bool parse_frame(const char *line, size_t length, laconic_frame *frame) {
    laconic_frame result = {0};
    uint32_t dlc;
    uint32_t byte;
    if (!kind_of(line[0], &result)) return false; /* the caller has asked the same before */
    const size_t id_digits = result.extended ? 8 : 3;
    if (length < 1U + id_digits + 1U) return false;
    if (!number(line + 1, id_digits, &result.id) || !number(line + 1 + id_digits, 1, &dlc)) return false;
    if (result.id > (result.extended ? 0x1FFFFFFFU : 0x7FFU) || (!result.fd && dlc > 8U)) return false;
    result.length = length_of(dlc);
    const size_t header = 1U + id_digits + 1U;
    if (length != header + (result.remote ? 0U : 2U * (size_t)result.length)) return false;
    for (size_t k = 0; !result.remote && k < result.length; k++) {
        if (!number(line + header + 2U * k, 2, &byte)) return false;
        result.data[k] = (uint8_t)byte;
    }
    *frame = result;
    return true;
}

static laconic_slcan_event reply(laconic_slcan *slcan, const char *text) {
    size_t k = 0;
    for (; text[k] != 0; k++) slcan->reply[k] = text[k];
    slcan->reply[k] = 0;
    return LACONIC_SLCAN_REPLY;
}

#define DONE "\r"
#define REFUSED "\a"

static laconic_slcan_event set_rate(laconic_slcan *slcan, size_t length) {
    const char rate = slcan->line[1];
    if (slcan->open || length != 2 || rate < '0' || rate > '8') return reply(slcan, REFUSED);
    slcan->rate_is_wrong = slcan->required_rate != 0 && rate != slcan->required_rate;
    return reply(slcan, DONE);
}

static laconic_slcan_event open_channel(laconic_slcan *slcan, bool listen_only) {
    if (slcan->open) return reply(slcan, REFUSED);
    slcan->open = true;
    slcan->listen_only = listen_only;
    return reply(slcan, DONE);
}

/* The letters of commands, by number: letters lie far apart, and a table of places would have a word for each between
 * them. */
static const char letters[] = "OLCSsYZVvNF";
enum {
    OPEN,
    LISTEN,
    CLOSE,
    RATE,
    RATE_BY_REGISTERS,
    DATA_RATE,
    TIME_STAMPS,
    VERSION,
    OLD_VERSION,
    SERIAL_NUMBER,
    FLAGS
};

static laconic_slcan_event command(laconic_slcan *slcan, size_t length) {
    uint32_t number = 0;
    while (letters[number] != 0 && letters[number] != slcan->line[0]) number++;
    switch (number) {
    case OPEN: return open_channel(slcan, false);
    case LISTEN: return open_channel(slcan, true);
    case CLOSE: slcan->open = false; return reply(slcan, DONE);
    case RATE: return set_rate(slcan, length);
    case RATE_BY_REGISTERS:
    case DATA_RATE:
    case TIME_STAMPS: return reply(slcan, slcan->open ? REFUSED : DONE);
    case VERSION:
    case OLD_VERSION: return reply(slcan, "V1010\r");
    case SERIAL_NUMBER: return reply(slcan, "NLACO\r");
    case FLAGS: return reply(slcan, "F00\r");
    default: return reply(slcan, REFUSED);
    }
}

static laconic_slcan_event end_of_line(laconic_slcan *slcan, laconic_frame *frame) {
    const size_t length = slcan->length;
    laconic_frame kind;
    slcan->length = 0;
    if (length == 0) return LACONIC_SLCAN_NOTHING;
    if (length >= LACONIC_SLCAN_LINE) return reply(slcan, REFUSED);
    if (!kind_of(slcan->line[0], &kind)) return command(slcan, length);
    if (!slcan->open || slcan->listen_only || slcan->rate_is_wrong) return reply(slcan, REFUSED);
    if (!parse_frame(slcan->line, length, frame)) return reply(slcan, REFUSED);
    (void)reply(slcan, DONE);
    return LACONIC_SLCAN_FRAME;
}

laconic_slcan_event laconic_slcan_feed(laconic_slcan *slcan, char byte, laconic_frame *frame) {
    if (byte == '\r') return end_of_line(slcan, frame);
    if (byte == '\n') return LACONIC_SLCAN_NOTHING;
    if (slcan->length < LACONIC_SLCAN_LINE) slcan->line[slcan->length++] = byte;
    return LACONIC_SLCAN_NOTHING;
}

static char *put(char *to, uint32_t value, unsigned digits) {
    while (digits-- > 0) *to++ = "0123456789ABCDEF"[(value >> (4U * digits)) & 15U];
    return to;
}

/* Only lengths that a DLC states have a line, and only frames that this build has room for. */
static bool has_line(const laconic_frame *frame) {
    return laconic_frame_fits(frame) && length_of(dlc_of(frame->length)) == frame->length;
}

static char letter_of(const laconic_frame *frame) {
    if (frame->fd) return (char)((frame->bit_rate_switch ? 'b' : 'd') - (frame->extended ? 'a' - 'A' : 0));
    return (char)((frame->remote ? 'r' : 't') - (frame->extended ? 'a' - 'A' : 0));
}

size_t laconic_slcan_write(const laconic_slcan *slcan, const laconic_frame *frame, char text[LACONIC_SLCAN_LINE]) {
    char *to = text;
    if (!slcan->open || slcan->rate_is_wrong || !has_line(frame)) return 0;
    *to++ = letter_of(frame);
    to = put(to, frame->id, frame->extended ? 8 : 3);
    to = put(to, dlc_of(frame->length), 1);
    for (uint8_t k = 0; !frame->remote && k < frame->length; k++) to = put(to, frame->data[k], 2);
    *to++ = '\r';
    return (size_t)(to - text);
}
