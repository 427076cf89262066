/* What the tests of saved states of any model share: an instance to bytes and back, and numbers that differ from each
 * other. */
#ifndef BYTES_BENCH_H
#define BYTES_BENCH_H

#include "fmi2_bench.h"
#include "model_interface.h"

static fmi2Byte bytes[65536];

/* What the rows of a vehicle's own numbers add to its state: it has the importer's vehicle and the prepared one. */
#define ONE_ROW(...) +1
#define VEHICLE_BYTES \
    (2U * sizeof(double) * \
     (size_t)(0 LACONIC_VEHICLE_FIELDS(ONE_ROW, ) LACONIC_PAYLOAD_FIELDS(ONE_ROW, ) LACONIC_GROUND_FIELDS(ONE_ROW, ) \
                  LACONIC_DRIVE_FIELDS(ONE_ROW, )))

static inline size_t write(void) {
    fmi2FMUstate kept = NULL;
    size_t size = 0;
    OK(fmi2GetFMUstate(c, &kept));
    OK(fmi2SerializedFMUstateSize(c, kept, &size));
    TEST_ASSERT_TRUE(size < sizeof bytes);
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    OK(fmi2FreeFMUstate(c, &kept));
    return size;
}

static inline fmi2Status read(size_t size) {
    fmi2FMUstate kept = NULL;
    const fmi2Status status = fmi2DeSerializeFMUstate(c, bytes, size, &kept);
    if (kept != NULL) OK(fmi2SetFMUstate(c, kept));
    OK(fmi2FreeFMUstate(c, &kept));
    return status;
}

static double filled;

/* Each number another one, with bits down to its last. */
static inline void fill(double *numbers, size_t size) {
    for (size_t k = 0; k < size / sizeof(double); k++) numbers[k] = (filled += 1) / 3;
}

#define FILL(member) fill((double *)(void *)&(member), sizeof(member))

/* Writes the instance, and reads it into another one. */
static inline void into_another(fmi2Type kind) {
    const size_t size = write();
    make(kind);
    OK(read(size));
}

#define COMES_BACK(member) \
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&before.member, &after->member, sizeof before.member, #member)

#endif
