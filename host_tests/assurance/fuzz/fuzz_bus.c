/* Any bytes as operations of FMI-LS-BUS: through the reader, the CAN controller and the clocks' buffers. What a
 * controller sends are operations that its own reader takes.
 *
 * Input: rounds, in each of which some operations are heard, a frame is sent and a time passes. */
#include <stdio.h>
#include <stdlib.h>

#include "can_controller.h"
#include "network_port.h"

#include "fuzz_bytes.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MOST_BYTES = 300 };

static const struct {
    uint8_t code, length; /* of the whole; frames: without data */
    uint8_t data_at;      /* of frames: where their length is   */
} kinds[] = {{0x01, 10, 8}, {0x10, 16, 14}, {0x11, 17, 15}, {0x12, 22, 20}, {0x20, 12, 0}, {0x30, 12, 0},
             {0x31, 15, 0}, {0x40, 13, 0},  {0x40, 10, 0},  {0x41, 9, 0},   {0x42, 8, 0},  {0x43, 8, 0}};

/* An operation of a kind, its arguments small numbers, its identifier often that of a frame on its way; then perhaps a
 * byte of it is changed. */
static size_t make_one(source *s, uint8_t *to, uint32_t id) {
    const unsigned how = next(s);
    const size_t kind = how % (sizeof kinds / sizeof kinds[0]);
    const uint8_t data = kinds[kind].data_at != 0 ? (uint8_t)(next(s) % 10U) : 0;
    const size_t length = (size_t)kinds[kind].length + data;
    for (size_t k = 8; k < length; k++) to[k] = (uint8_t)(next(s) % 3U);
    memset(to, 0, 8);
    to[0] = kinds[kind].code;
    to[4] = (uint8_t)length;
    if (length >= 12 && kinds[kind].code != 0x01 && kinds[kind].code != 0x40 && how > 127) {
        const uint8_t number[4] = {(uint8_t)(id & 255U), (uint8_t)(id >> 8), 0, 0};
        memcpy(to + 8, number, 4);
    }
    if (data != 0) to[kinds[kind].data_at] = data;
    if (kinds[kind].data_at != 0) to[kinds[kind].data_at + 1] = 0;
    if (next(s) > 200) to[next(s) % length] = (uint8_t)next(s);
    return length;
}

static void check(const ls_bus_buffer *tx) {
    ls_bus_operation operation;
    size_t at = 0;
    ls_bus_reading reading;
    while ((reading = ls_bus_read(tx->bytes, tx->size, &at, &operation)) == LS_BUS_RIGHT) continue;
    if (reading == LS_BUS_END) return;
    fprintf(stderr, "operation 0x%X of %zu bytes, which was sent, is wrong\n", (unsigned)operation.code,
            operation.size);
    abort();
}

static void hear(source *s, can_controller *controller, network_port *port, uint64_t now_us) {
    uint8_t bytes[MOST_BYTES];
    size_t size = 0, at = 0;
    while (size + 60 < MOST_BYTES && next(s) % 4 != 0) size += make_one(s, bytes + size, controller->on_its_way.id);
    if (size > 0 && next(s) > 230) size--;
    uint8_t *exact = malloc(size > 0 ? size : 1); /* of its own size, so that a sanitizer sees each byte beyond it */
    ls_bus_operation operation;
    ls_bus_reading reading;
    memcpy(exact, bytes, size);
    while ((reading = ls_bus_read(exact, size, &at, &operation)) != LS_BUS_END)
        can_controller_hear(controller, &port->tx, reading, &operation, now_us);
    free(exact);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static network_port port;
    source s = {data, size, 0};
    can_controller controller = {.notified = true, .bit_rate_bit_per_s = 1000000, .fd_bit_rate_bit_per_s = 5000000};
    memset(&port, 0, sizeof port);
    can_controller_start(&controller, &port.tx);
    for (uint64_t now_us = 0; s.at < s.size; now_us += 100U * next(&s)) {
        const laconic_frame frame = {.id = next_word(&s) % 2048U, .length = (uint8_t)(next(&s) % 9U)};
        hear(&s, &controller, &port, now_us);
        if (can_controller_is_free(&controller, &port.tx)) can_controller_send(&controller, &port.tx, &frame);
        can_controller_tick(&controller, &port.tx, now_us);
        check(&port.tx);
        if (next(&s) > 240) {
            network_port_activate(&port);
            network_ports_settle(&port, 1);
        }
    }
    return 0;
}
