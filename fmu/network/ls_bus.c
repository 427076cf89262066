/* Bus operations to bytes and back. */
#include "ls_bus.h"

#include <string.h>

#define HEADER 8U
#define CAN_HEADER 16U
#define CAN_FD_HEADER 17U
#define MOST_IN_FORMAT_ERROR 65535U

static void put(uint8_t *to, uint32_t value, unsigned bytes) {
    for (unsigned k = 0; k < bytes; k++) to[k] = (uint8_t)(value >> (8U * k) & 255U);
}

static uint32_t get(const uint8_t *from, unsigned bytes) {
    uint32_t value = 0;
    for (unsigned k = 0; k < bytes; k++) value |= (uint32_t)from[k] << (8U * k);
    return value;
}

/* Room for an operation of `size` bytes, its header written; NULL: there is none. */
static uint8_t *begin(ls_bus_buffer *to, enum ls_bus_code code, size_t size) {
    uint8_t *at = &to->bytes[to->size];
    if (!ls_bus_has_room(to, size)) return NULL;
    put(at, (uint32_t)code, 4);
    put(at + 4, (uint32_t)size, 4);
    to->size += size;
    return at;
}

bool ls_bus_put_frame(ls_bus_buffer *to, const laconic_frame *frame, bool error_passive) {
    const size_t header = frame->fd ? CAN_FD_HEADER : CAN_HEADER;
    uint8_t *at = begin(to, frame->fd ? LS_BUS_CAN_FD_TRANSMIT : LS_BUS_CAN_TRANSMIT, header + frame->length);
    if (at == NULL) return false;
    put(at + 8, frame->id, 4);
    at[12] = frame->extended;
    at[13] = frame->fd ? frame->bit_rate_switch : frame->remote;
    if (frame->fd) at[14] = error_passive;
    put(at + header - 2, frame->length, 2);
    memcpy(at + header, frame->data, frame->length);
    return true;
}

bool ls_bus_put_id(ls_bus_buffer *to, enum ls_bus_code code, uint32_t id) {
    uint8_t *at = begin(to, code, 12);
    if (at != NULL) put(at + 8, id, 4);
    return at != NULL;
}

bool ls_bus_put_error(ls_bus_buffer *to, uint32_t id, enum ls_bus_error error, enum ls_bus_flag flag, bool is_sender) {
    uint8_t *at = begin(to, LS_BUS_BUS_ERROR, 15);
    if (at == NULL) return false;
    put(at + 8, id, 4);
    at[12] = (uint8_t)error;
    at[13] = (uint8_t)flag;
    at[14] = is_sender;
    return true;
}

bool ls_bus_put_configuration(ls_bus_buffer *to, enum ls_bus_parameter parameter, uint32_t value) {
    const unsigned bytes = parameter == LS_BUS_ARBITRATION_LOST_BEHAVIOR ? 1 : 4;
    uint8_t *at = begin(to, LS_BUS_CONFIGURATION, 9 + bytes);
    if (at == NULL) return false;
    at[8] = (uint8_t)parameter;
    put(at + 9, value, bytes);
    return true;
}

bool ls_bus_put_status(ls_bus_buffer *to, enum ls_bus_status status) {
    uint8_t *at = begin(to, LS_BUS_STATUS, 9);
    if (at != NULL) at[8] = (uint8_t)status;
    return at != NULL;
}

bool ls_bus_put_format_error(ls_bus_buffer *to, const uint8_t *bytes, size_t size) {
    const size_t kept = size < MOST_IN_FORMAT_ERROR ? size : MOST_IN_FORMAT_ERROR;
    uint8_t *at = begin(to, LS_BUS_FORMAT_ERROR, 10 + kept);
    if (at == NULL) return false;
    put(at + 8, (uint32_t)kept, 2);
    memcpy(at + 10, bytes, kept);
    return true;
}

void ls_bus_drop(ls_bus_buffer *from, size_t size) {
    if (size > from->size) size = from->size;
    memmove(from->bytes, from->bytes + size, from->size - size);
    from->size -= size;
}

/* ----------------------------------------------------------------------------------------- reading -- */

static bool is_truth(uint8_t value) { return value <= 1; }

static bool is_length_of_fd(uint32_t length) {
    static const uint8_t longer[] = {12, 16, 20, 24, 32, 48, 64};
    for (size_t k = 0; k < sizeof longer; k++)
        if (length == longer[k]) return true;
    return length <= 8;
}

static bool read_frame(ls_bus_operation *to, const uint8_t *at) {
    const bool fd = to->code == LS_BUS_CAN_FD_TRANSMIT;
    const size_t header = fd ? CAN_FD_HEADER : CAN_HEADER;
    if (to->size < header) return false;
    const uint32_t id = get(at + 8, 4), length = get(at + header - 2, 2);
    if (!is_truth(at[12]) || !is_truth(at[13]) || (fd && !is_truth(at[14]))) return false;
    if (id > (at[12] ? 0x1FFFFFFFU : 0x7FFU) || to->size != header + length) return false;
    if (fd ? !is_length_of_fd(length) : length > 8) return false;
    const laconic_frame frame = {.id = id,
                                 .length = (uint8_t)length,
                                 .extended = at[12] != 0,
                                 .remote = !fd && at[13] != 0,
                                 .fd = fd,
                                 .bit_rate_switch = fd && at[13] != 0};
    to->frame = frame;
    to->error_passive = fd && at[14] != 0;
    to->id = id;
    memcpy(to->frame.data, at + header, length);
    return true;
}

static bool read_error(ls_bus_operation *to, const uint8_t *at) {
    if (to->size != 15) return false;
    to->id = get(at + 8, 4);
    to->error = at[12];
    to->flag = at[13];
    to->is_sender = at[14] != 0;
    return at[12] >= 1 && at[12] <= LS_BUS_LAST_ERROR && at[13] >= 1 && at[13] <= 2 && is_truth(at[14]);
}

static bool read_configuration(ls_bus_operation *to, const uint8_t *at) {
    if (to->size < 10) return false;
    const unsigned bytes = at[8] == LS_BUS_ARBITRATION_LOST_BEHAVIOR ? 1 : 4;
    to->parameter = at[8];
    if (to->size != 9 + bytes || at[8] < LS_BUS_CAN_BAUDRATE || at[8] > LS_BUS_ARBITRATION_LOST_BEHAVIOR) return false;
    to->value = get(at + 9, bytes);
    return bytes == 4 || to->value == LS_BUS_BUFFER_AND_RETRANSMIT || to->value == LS_BUS_DISCARD_AND_NOTIFY;
}

static bool read_status(ls_bus_operation *to, const uint8_t *at) {
    if (to->size != 9) return false;
    to->status = at[8];
    return at[8] >= LS_BUS_ERROR_ACTIVE && at[8] <= LS_BUS_BUS_OFF;
}

static bool read_arguments(ls_bus_operation *to, const uint8_t *at) {
    switch (to->code) {
    case LS_BUS_FORMAT_ERROR: return to->size >= 10 && to->size == 10 + get(at + 8, 2);
    case LS_BUS_CAN_TRANSMIT:
    case LS_BUS_CAN_FD_TRANSMIT: return read_frame(to, at);
    case LS_BUS_CAN_XL_TRANSMIT: return to->size >= 22 && to->size == 22 + get(at + 20, 2);
    case LS_BUS_CONFIRM:
    case LS_BUS_ARBITRATION_LOST: to->id = to->size == 12 ? get(at + 8, 4) : 0; return to->size == 12;
    case LS_BUS_BUS_ERROR: return read_error(to, at);
    case LS_BUS_CONFIGURATION: return read_configuration(to, at);
    case LS_BUS_STATUS: return read_status(to, at);
    case LS_BUS_WAKEUP: return to->size == HEADER;
    default: return false;
    }
}

ls_bus_reading ls_bus_read(const uint8_t *bytes, size_t size, size_t *at, ls_bus_operation *operation) {
    const uint8_t *here = bytes + *at;
    const size_t left = size - *at;
    const ls_bus_operation fresh = {.bytes = here, .size = left};
    if (left == 0) return LS_BUS_END;
    *operation = fresh;
    if (left >= 4) operation->code = get(here, 4);
    const uint32_t length = left >= HEADER ? get(here + 4, 4) : 0;
    const bool fits = length >= HEADER && length <= left;
    if (fits) operation->size = length;
    *at += operation->size;
    return fits && read_arguments(operation, here) ? LS_BUS_RIGHT : LS_BUS_WRONG;
}
