/* Any parameters: the loader writes only into its parameters, and the core accepts or refuses every result.
 *
 * Input: records of 7 bytes: the payload of PARAMETER from byte 2 on, and its upper half flag. */
#include "laconic_node/loader.h"
#include "laconic_wire.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { RECORD = 7, GUARD = 0x5A };

typedef struct guarded {
    uint8_t before[16];
    laconic_loader loader;
    uint8_t after[16];
} guarded;

static void must(bool holds) {
    if (!holds) abort();
}

static void prepare(const laconic_parameters *parameters) {
    static laconic_plant plant;
    const laconic_method *method = laconic_method_by_number(parameters->method);
    laconic_refusal why = {0};
    if (method == NULL) return;
    const laconic_status status =
        laconic_plant_start(&plant, &parameters->vehicle, method, parameters->step_s, &parameters->start, &why);
    must(status == why.status && status < LACONIC_STATUS_COUNT);
    if (status == LACONIC_OK) {
        const laconic_input none = {{0}, {0}, {0, 0}, 0, {0, 0}, {0, 0}};
        laconic_plant_run(&plant, &none, 2, &why);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static guarded memory;
    memset(&memory, GUARD, sizeof memory);
    laconic_loader_begin(&memory.loader);
    for (; size >= RECORD; data += RECORD, size -= RECORD) {
        uint8_t payload[8] = {0, (uint8_t)(data[6] << 4 & 0x10U)};
        memcpy(payload + 2, data, 6);
        laconic_loader_take(&memory.loader, payload);
    }
    for (int k = 0; k < 16; k++) must(memory.before[k] == GUARD && memory.after[k] == GUARD);
    uint8_t field, item;
    const uint16_t count = memory.loader.frame_count;
    must(laconic_loader_check(&memory.loader, count, ~memory.loader.checksum + 1U, &field, &item) != 0);
    if (laconic_loader_check(&memory.loader, count, ~memory.loader.checksum, &field, &item) == 0)
        prepare(&memory.loader.parameters);
    return 0;
}
