/* Subframes: from 0x00 writes, from 0x10 reads, 0x40 and 0x42 tunnelled streams, 0x50 nothing. */
#include "../octets.h"
#include "moteus.h"

enum { WRITES = 0x00, READS = 0x10, REPLY = 0x20, WRITE_ERROR = 0x30, READ_ERROR = 0x31 };
enum { CLIENT_DATA = 0x40, SERVER_DATA = 0x41, CLIENT_POLL = 0x42, NOTHING = 0x50 };

/* The frame that is read, from `at` on. */
typedef struct reader {
    const uint8_t *data;
    uint32_t length, at;
} reader;

static bool read_varuint(reader *from, uint32_t *value) {
    *value = 0;
    for (uint32_t shift = 0; shift < 35 && from->at < from->length; shift += 7) {
        const uint8_t octet = from->data[from->at++];
        *value |= (uint32_t)(octet & 0x7FU) << shift;
        if ((octet & 0x80U) == 0) return true;
    }
    return false;
}

static uint32_t extent_of(uint32_t value) {
    return value < 0x80 ? 1 : value < 0x4000 ? 2 : value < 0x200000 ? 3 : value < 0x10000000 ? 4 : 5;
}

/* False: the reply has no room left. */
static bool put_varuint(moteus_axis *axis, uint32_t value) {
    if (axis->reply_length + extent_of(value) > LACONIC_FRAME_BYTES) return false;
    for (; value >= 0x80; value >>= 7) axis->reply[axis->reply_length++] = (uint8_t)(value | 0x80U);
    axis->reply[axis->reply_length++] = (uint8_t)value;
    return true;
}

static void put_error(moteus_axis *axis, uint32_t kind, uint32_t number, uint32_t error) {
    const uint8_t length = axis->reply_length;
    if (!axis->answers) return;
    if (!put_varuint(axis, kind) || !put_varuint(axis, number) || !put_varuint(axis, error))
        axis->reply_length = length;
}

/* How many registers, and the first one. */
static bool read_range(reader *from, uint32_t kind, uint32_t *count, uint32_t *number) {
    *count = kind & 3U;
    return (*count != 0 || read_varuint(from, count)) && read_varuint(from, number);
}

static bool write_registers(laconic_drives *drives, int32_t i, reader *from, uint32_t kind) {
    moteus_axis *axis = moteus_axis_of(drives, i);
    const uint32_t type = kind >> 2 & 3U, extent = moteus_extent(type);
    uint32_t count, number;
    if (!read_range(from, kind, &count, &number)) return false;
    for (; count > 0; count--, number++) {
        if (from->length - from->at < extent) return false;
        const uint32_t error = moteus_write(drives, i, number, type, from->data + from->at);
        from->at += extent;
        if (axis->discarded) return false;
        if (error) put_error(axis, WRITE_ERROR, number, error);
    }
    return true;
}

static bool put_register(laconic_drives *drives, int32_t i, uint32_t number, uint32_t type, uint32_t *error) {
    moteus_axis *axis = moteus_axis_of(drives, i);
    uint8_t value[4];
    *error = moteus_read(drives, i, number, type, value);
    const uint32_t extent = moteus_extent(type);
    if (*error || axis->reply_length + extent > LACONIC_FRAME_BYTES) return false;
    memcpy(axis->reply + axis->reply_length, value, extent);
    axis->reply_length = (uint8_t)(axis->reply_length + extent);
    return true;
}

/* One register that cannot be read spoils its range: the error stands in its place, the rest of the frame is left. */
static bool read_registers(laconic_drives *drives, int32_t i, reader *from, uint32_t kind) {
    moteus_axis *axis = moteus_axis_of(drives, i);
    const uint8_t length = axis->reply_length;
    uint32_t count, number, error = 0;
    if (!read_range(from, kind, &count, &number)) return false;
    if (!axis->answers) return true;
    bool has_room = put_varuint(axis, REPLY | (kind & 0xFU)) && ((kind & 3U) != 0 || put_varuint(axis, count)) &&
                    put_varuint(axis, number);
    for (; has_room && count > 0; count--, number++) {
        has_room = put_register(drives, i, number, kind >> 2 & 3U, &error);
        if (error) break;
    }
    if (has_room) return true;
    axis->reply_length = length;
    if (error) put_error(axis, READ_ERROR, number, error);
    return false;
}

/* The diagnostic stream (channel 1) exists but is mute: what is written to it is lost, a poll gets no bytes. */
static bool answer_stream(moteus_axis *axis, reader *from, bool with_data) {
    uint32_t channel, size;
    if (!read_varuint(from, &channel) || !read_varuint(from, &size) || channel != 1) return false;
    if (with_data && from->length - from->at < size) return false;
    if (with_data) from->at += size;
    const uint8_t length = axis->reply_length;
    if (axis->answers && (!put_varuint(axis, SERVER_DATA) || !put_varuint(axis, channel) || !put_varuint(axis, 0)))
        axis->reply_length = length;
    return true;
}

/* False: the rest of the frame cannot be used. */
static bool take_subframe(laconic_drives *drives, int32_t i, reader *from) {
    uint32_t kind;
    if (!read_varuint(from, &kind)) return false;
    if (kind < READS) return write_registers(drives, i, from, kind - WRITES);
    if (kind < REPLY) return read_registers(drives, i, from, kind - READS);
    if (kind == CLIENT_DATA || kind == CLIENT_POLL)
        return answer_stream(moteus_axis_of(drives, i), from, kind == CLIENT_DATA);
    return kind == NOTHING;
}

/* Where a reply still waits to be sent this frame gets none, as with the server. */
static void begin_reply(moteus_axis *axis, const laconic_frame *frame) {
    axis->answers = !axis->waits && (frame->id & 0x8000U) != 0;
    if (!axis->answers) return;
    axis->reply_length = 0;
    axis->reply_to = (uint8_t)(frame->id >> 8 & 0x7FU);
    axis->reply_fd = frame->fd;
    axis->reply_bit_rate_switch = frame->bit_rate_switch;
}

void moteus_take(laconic_drives *drives, int32_t i, const laconic_frame *frame) {
    moteus_axis *axis = moteus_axis_of(drives, i);
    reader from = {frame->data, frame->length, 0};
    axis->commanded = axis->discarded = false;
    begin_reply(axis, frame);
    moteus_update_status(drives, i);
    while (from.at < from.length && take_subframe(drives, i, &from)) continue;
    if (axis->discarded) return;
    axis->waits = axis->waits || axis->answers;
    if (axis->commanded) moteus_command_drive(drives, axis, &drives->drive[i]);
}

static uint8_t padded(uint8_t length) {
    static const uint8_t lengths[] = {8, 12, 16, 20, 24, 32, 48, 64};
    if (length <= 8) return length;
    uint32_t k = 0;
    while (lengths[k] < length) k++;
    return lengths[k];
}

void moteus_reply(moteus_axis *axis, laconic_frame *frame) {
    memset(frame, 0, sizeof *frame);
    frame->id = (uint32_t)axis->node_id << 8 | axis->reply_to;
    frame->extended = frame->id > 0x7FF;
    frame->fd = axis->reply_fd || axis->reply_length > 8;
    frame->bit_rate_switch = frame->fd && axis->reply_bit_rate_switch;
    frame->length = padded(axis->reply_length);
    memset(frame->data, NOTHING, frame->length);
    memcpy(frame->data, axis->reply, axis->reply_length);
    axis->waits = false;
}
