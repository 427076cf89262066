/* Bytes of a saved state, wrong ones under a right checksum most of the time: what is refused changes nothing, what is
 * accepted gives the same bytes again, and the instance goes on with numbers.
 *
 * Input: which instance, how it is spoilt, then patches of 10 bytes (place, 8 bytes) of a good state; or the bytes
 * alone. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"
#include "long_steps.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

#define STEP_S 0.01

enum { PATCH = 10, INSTANCES = 2, LARGEST = 1 << 14, X = 38 };

/* One for all inputs: a Co-Simulation and a Model Exchange instance, each with its state after initialization. */
typedef struct bench {
    fmi3Instance instance;
    fmi3FMUState clean;
    fmi3Byte good[LARGEST];
    size_t size;
} bench;

static bench benches[INSTANCES];

/* Ends the program where a promise is broken, and says which. */
#define must(holds) ((holds) ? (void)0 : broken(#holds, __LINE__))

static void broken(const char *what, int line) {
    fprintf(stderr, "line %d: not so: %s\n", line, what);
    abort();
}

static void begin(bench *on, bool exchange) {
    on->instance = exchange ? fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, false, NULL, NULL)
                            : fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, false, false, false, NULL, 0,
                                                          NULL, NULL, NULL);
    must(on->instance != NULL);
    must(fmi3EnterInitializationMode(on->instance, false, 0.0, 0.0, false, 0.0) == fmi3OK);
    must(fmi3ExitInitializationMode(on->instance) == fmi3OK);
    must(fmi3GetFMUState(on->instance, &on->clean) == fmi3OK);
    must(fmi3SerializedFMUStateSize(on->instance, on->clean, &on->size) == fmi3OK && on->size <= LARGEST);
    must(fmi3SerializeFMUState(on->instance, on->clean, on->good, on->size) == fmi3OK);
}

static void put_checksum(fmi3Byte *bytes, size_t size) {
    const uint64_t sum = fmu_checksum(bytes, size - 8);
    for (int k = 0; k < 8; k++) bytes[size - 8 + (size_t)k] = (fmi3Byte)(sum >> (8 * k));
}

/* The bytes of an input; how many. */
static size_t spoil(const bench *on, fmi3Byte *to, const uint8_t *from, size_t size) {
    const uint8_t how = *from++;
    size--;
    if (how % 16 == 0) {
        memcpy(to, from, size);
        return size;
    }
    memcpy(to, on->good, on->size);
    for (; size >= PATCH; from += PATCH, size -= PATCH) {
        const size_t at = ((size_t)from[0] | (size_t)from[1] << 8) * (how % 2 ? 8U : 1U) % (on->size - 8U);
        const size_t room = on->size - 8U - at;
        memcpy(to + at, from + 2, room < 8 ? room : 8);
    }
    if (how % 16 != 1) put_checksum(to, on->size);
    return how % 16 == 2 ? on->size - 1 : on->size;
}

static void use(bench *on, bool exchange) {
    const fmi3ValueReference x = X;
    fmi3Float64 value = 0.0, time;
    fmi3Boolean flag[3];
    if (fmi3GetFloat64(on->instance, &x, 1, &value, 1) == fmi3OK) must(fmu_is_finite(value));
    if (!exchange && !takes_too_long(on->instance, STEP_S))
        (void)fmi3DoStep(on->instance, 0.0, STEP_S, true, &flag[0], &flag[1], &flag[2], &time);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static fmi3Byte spoilt[LARGEST], again[LARGEST];
    fmi3FMUState state = NULL;
    if (benches[0].instance == NULL)
        for (int k = 0; k < INSTANCES; k++) begin(&benches[k], k == 1);
    if (size < 2 || size > 2000) return 0;
    const bool exchange = bytes[0] % 2 != 0;
    bench *on = &benches[exchange];
    const size_t count = spoil(on, spoilt, bytes + 1, size - 1);
    const bool taken = fmi3DeserializeFMUState(on->instance, spoilt, count, &state) == fmi3OK;
    must(taken == (state != NULL));
    if (taken) {
        must(fmi3SerializeFMUState(on->instance, state, again, count) == fmi3OK);
        must(memcmp(again, spoilt, count) == 0);
        if (fmi3SetFMUState(on->instance, state) == fmi3OK) use(on, exchange);
        must(fmi3FreeFMUState(on->instance, &state) == fmi3OK);
    }
    must(fmi3SetFMUState(on->instance, on->clean) == fmi3OK);
    return 0;
}
