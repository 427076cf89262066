/* Numbers to and from bytes, little-endian on every machine. The same calls write, read or count. */
#ifndef LACONIC_FMU_STREAM_H
#define LACONIC_FMU_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct fmu_stream {
    uint8_t *to;         /* writing, unless NULL                   */
    const uint8_t *from; /* reading, unless NULL; both NULL: counts */
    size_t size, at;
    bool failed; /* the bytes were too few, or a value out of range */
} fmu_stream;

void fmu_stream_u64(fmu_stream *stream, uint64_t *value);
void fmu_stream_i64(fmu_stream *stream, int64_t *value);
void fmu_stream_i32(fmu_stream *stream, int32_t *value, int32_t least, int32_t most);
void fmu_stream_bool(fmu_stream *stream, bool *value);
void fmu_stream_reals(fmu_stream *stream, double *values, size_t count);

/* CRC-32 (IEEE 802.3) of the bytes. */
uint32_t fmu_checksum(const uint8_t *bytes, size_t size);

#endif
