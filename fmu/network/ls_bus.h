/* Bus operations of FMI-LS-BUS 1.0 for CAN and CAN FD, as bytes: the content of Tx_Data and Rx_Data. An operation is
 * opcode (4 bytes), length of the whole (4 bytes) and arguments, all numbers little-endian; several may follow each
 * other. */
#ifndef LACONIC_FMU_NETWORK_LS_BUS_H
#define LACONIC_FMU_NETWORK_LS_BUS_H

#include <stddef.h>

#include "laconic_node/frame.h"

#if !LACONIC_NODE_CAN_FD
#error "laconic: FMUs with a bus read frames of CAN FD: compile them without LACONIC_NODE_CAN_FD=0"
#endif

enum ls_bus_code {
    LS_BUS_FORMAT_ERROR = 0x01,
    LS_BUS_CAN_TRANSMIT = 0x10,
    LS_BUS_CAN_FD_TRANSMIT = 0x11,
    LS_BUS_CAN_XL_TRANSMIT = 0x12,
    LS_BUS_CONFIRM = 0x20,
    LS_BUS_ARBITRATION_LOST = 0x30,
    LS_BUS_BUS_ERROR = 0x31,
    LS_BUS_CONFIGURATION = 0x40,
    LS_BUS_STATUS = 0x41,
    LS_BUS_WAKEUP = 0x42
};

enum ls_bus_parameter {
    LS_BUS_CAN_BAUDRATE = 1,
    LS_BUS_CAN_FD_BAUDRATE = 2,
    LS_BUS_CAN_XL_BAUDRATE = 3,
    LS_BUS_ARBITRATION_LOST_BEHAVIOR = 4
};
enum ls_bus_behavior { LS_BUS_BUFFER_AND_RETRANSMIT = 1, LS_BUS_DISCARD_AND_NOTIFY = 2 };
enum ls_bus_status { LS_BUS_ERROR_ACTIVE = 1, LS_BUS_ERROR_PASSIVE = 2, LS_BUS_BUS_OFF = 3 };
enum ls_bus_error { LS_BUS_CRC_ERROR = 4, LS_BUS_LAST_ERROR = 6 };
enum ls_bus_flag { LS_BUS_PRIMARY_ERROR_FLAG = 1, LS_BUS_SECONDARY_ERROR_FLAG = 2 };

#define LS_BUS_LARGEST_OPERATION 81U /* a CAN FD frame of 64 bytes */

/* Operations in a row. The capacity is what the descriptions declare as maxSize. */
#define LS_BUS_BUFFER_BYTES 32768U
typedef struct ls_bus_buffer {
    size_t size;
    uint8_t bytes[LS_BUS_BUFFER_BYTES];
} ls_bus_buffer;

static inline bool ls_bus_has_room(const ls_bus_buffer *buffer, size_t bytes) {
    return bytes <= LS_BUS_BUFFER_BYTES - buffer->size;
}

/* Each appends one operation whole; false iff there is no room, and nothing is appended. */
bool ls_bus_put_frame(ls_bus_buffer *to, const laconic_frame *frame, bool error_passive);
bool ls_bus_put_id(ls_bus_buffer *to, enum ls_bus_code code, uint32_t id); /* CONFIRM, ARBITRATION_LOST */
bool ls_bus_put_error(ls_bus_buffer *to, uint32_t id, enum ls_bus_error error, enum ls_bus_flag flag, bool is_sender);
bool ls_bus_put_configuration(ls_bus_buffer *to, enum ls_bus_parameter parameter, uint32_t value);
bool ls_bus_put_status(ls_bus_buffer *to, enum ls_bus_status status);
/* The answer to an operation that is wrong, with its bytes; of more than 65,535 bytes the first ones. */
bool ls_bus_put_format_error(ls_bus_buffer *to, const uint8_t *bytes, size_t size);

/* Takes the first `size` bytes away. */
void ls_bus_drop(ls_bus_buffer *from, size_t size);

/* One operation that was read; the members that belong to its code. */
typedef struct ls_bus_operation {
    uint32_t code;
    const uint8_t *bytes; /* of the whole operation */
    size_t size;
    laconic_frame frame;
    bool error_passive; /* its sender is, as a frame of CAN FD says (ESI) */
    uint32_t id;
    uint8_t error, flag;
    bool is_sender;
    uint8_t parameter, status;
    uint32_t value;
} ls_bus_operation;

typedef enum ls_bus_reading { LS_BUS_END, LS_BUS_RIGHT, LS_BUS_WRONG } ls_bus_reading;

/* Reads the operation at *at and moves *at behind it. WRONG: code, length or an argument is none of the standard's;
 * where the length cannot be trusted the operation is all that is left. Only code, bytes and size are then valid. */
ls_bus_reading ls_bus_read(const uint8_t *bytes, size_t size, size_t *at, ls_bus_operation *operation);

#endif
