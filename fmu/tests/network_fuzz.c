/* Random bytes as bus operations, under sanitizers: through the reader, the CAN controller and the clocks' buffers.
 *
 *     fmu_network_fuzz ROUNDS SEED */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "can_controller.h"
#include "network_port.h"

#define MOST_BYTES 600U

static uint64_t state;

static uint32_t next(uint32_t bound) { /* xorshift64* */
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return (uint32_t)((state * 0x2545F4914F6CDD1DU) >> 33) % bound;
}

static const struct {
    uint8_t code, length; /* of the whole; frames: without data */
    uint8_t data_at;      /* of frames: where their length is   */
} kinds[] = {{0x01, 10, 8}, {0x10, 16, 14}, {0x11, 17, 15}, {0x12, 22, 20}, {0x20, 12, 0}, {0x30, 12, 0},
             {0x31, 15, 0}, {0x40, 13, 0},  {0x40, 10, 0},  {0x41, 9, 0},   {0x42, 8, 0},  {0x43, 8, 0}};

/* An operation of a kind, its arguments small numbers, its identifier often that of a frame on its way; then perhaps a
 * byte of it is changed. */
static size_t make_one(uint8_t *to, uint32_t id) {
    const size_t kind = next((uint32_t)(sizeof kinds / sizeof kinds[0]));
    const uint8_t data = kinds[kind].data_at != 0 ? (uint8_t)next(10) : 0;
    const size_t length = (size_t)kinds[kind].length + data;
    for (size_t k = 8; k < length; k++) to[k] = (uint8_t)next(3);
    memset(to, 0, 8);
    to[0] = kinds[kind].code;
    to[4] = (uint8_t)length;
    if (length >= 12 && kinds[kind].code != 0x01 && kinds[kind].code != 0x40 && next(2) == 0) {
        const uint8_t number[4] = {(uint8_t)(id & 255U), (uint8_t)(id >> 8), 0, 0};
        memcpy(to + 8, number, 4);
    }
    if (data != 0) to[kinds[kind].data_at] = data;
    if (kinds[kind].data_at != 0) to[kinds[kind].data_at + 1] = 0;
    if (next(5) == 0) to[next((uint32_t)length)] = (uint8_t)next(256);
    return length;
}

static size_t make(uint8_t *bytes, uint32_t id) {
    size_t size = 0;
    while (size + 100 < MOST_BYTES && next(4) != 0) size += make_one(bytes + size, id);
    return next(10) == 0 && size > 0 ? size - 1 : size;
}

/* What a controller sends must be operations that its own reader takes. */
static void check(const ls_bus_buffer *tx) {
    ls_bus_operation operation;
    size_t at = 0;
    ls_bus_reading reading;
    while ((reading = ls_bus_read(tx->bytes, tx->size, &at, &operation)) == LS_BUS_RIGHT) continue;
    if (reading == LS_BUS_END) return;
    fprintf(stderr, "operation 0x%X of %zu bytes, which was sent, is wrong\n", (unsigned)operation.code,
            operation.size);
    exit(1);
}

int main(int count, char **arguments) {
    const long rounds = count > 1 ? strtol(arguments[1], NULL, 10) : 1000;
    static network_port port;
    can_controller controller = {.notified = true, .bit_rate_bit_per_s = 1000000, .fd_bit_rate_bit_per_s = 5000000};
    state = 0x9E3779B97F4A7C15U ^ (uint64_t)(count > 2 ? strtol(arguments[2], NULL, 10) : 1);
    can_controller_start(&controller, &port.tx);
    for (long round = 0; round < rounds; round++) {
        const laconic_frame frame = {.id = next(2048), .length = (uint8_t)next(9)};
        uint8_t *bytes = malloc(MOST_BYTES); /* of its own size, so that a sanitizer sees each byte beyond it */
        const size_t size = make(bytes, controller.on_its_way.id);
        uint8_t *exact = malloc(size + 1);
        ls_bus_operation operation;
        ls_bus_reading reading;
        size_t at = 0;
        memcpy(exact, bytes, size);
        exact = realloc(exact, size > 0 ? size : 1);
        while ((reading = ls_bus_read(exact, size, &at, &operation)) != LS_BUS_END)
            can_controller_hear(&controller, &port.tx, reading, &operation, (uint64_t)round * 100U);
        if (can_controller_is_free(&controller, &port.tx)) can_controller_send(&controller, &port.tx, &frame);
        can_controller_tick(&controller, &port.tx, (uint64_t)round * 100U);
        check(&port.tx);
        if (next(20) == 0) {
            network_port_activate(&port);
            network_ports_settle(&port, 1);
        }
        free(exact);
        free(bytes);
    }
    printf("%ld rounds: %d frames sent, %d heard, %d wrong operations\n", rounds, (int)controller.sent,
           (int)controller.heard, (int)controller.wrong);
    return 0;
}
