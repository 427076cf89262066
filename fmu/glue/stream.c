/* Numbers to and from bytes, one byte after the other, and the checksum that ends a file. */
#include "stream.h"

#include <string.h>

void fmu_stream_u64(fmu_stream *stream, uint64_t *value) {
    if (stream->size - stream->at < 8 && (stream->to != NULL || stream->from != NULL)) {
        stream->failed = true;
        return;
    }
    if (stream->from != NULL) {
        *value = 0;
        for (unsigned k = 0; k < 8; k++) *value |= (uint64_t)stream->from[stream->at + k] << (8 * k);
    }
    if (stream->to != NULL)
        for (unsigned k = 0; k < 8; k++) stream->to[stream->at + k] = (uint8_t)(*value >> (8 * k));
    stream->at += 8;
}

void fmu_stream_i64(fmu_stream *stream, int64_t *value) {
    uint64_t bits = 0;
    memcpy(&bits, value, sizeof bits);
    fmu_stream_u64(stream, &bits);
    if (stream->from != NULL) memcpy(value, &bits, sizeof bits);
}

void fmu_stream_i32(fmu_stream *stream, int32_t *value, int32_t least, int32_t most) {
    int64_t wide = *value;
    fmu_stream_i64(stream, &wide);
    if (stream->from == NULL) return;
    if (wide < least || wide > most)
        stream->failed = true;
    else
        *value = (int32_t)wide;
}

void fmu_stream_bool(fmu_stream *stream, bool *value) {
    int32_t number = *value;
    fmu_stream_i32(stream, &number, 0, 1);
    if (stream->from != NULL) *value = number != 0;
}

void fmu_stream_reals(fmu_stream *stream, double *values, size_t count) {
    for (size_t k = 0; k < count; k++) {
        uint64_t bits = 0;
        memcpy(&bits, &values[k], sizeof bits);
        fmu_stream_u64(stream, &bits);
        if (stream->from != NULL) memcpy(&values[k], &bits, sizeof bits);
    }
}

/* Half a byte at a time: a quarter of the steps of single bits, and a table of 64 bytes. */
uint32_t fmu_checksum(const uint8_t *bytes, size_t size) {
    static const uint32_t table[16] = {0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU, 0x76DC4190U, 0x6B6B51F4U,
                                       0x4DB26158U, 0x5005713CU, 0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
                                       0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};
    uint32_t remainder = 0xFFFFFFFFU;
    for (size_t k = 0; k < size; k++) {
        remainder ^= bytes[k];
        remainder = (remainder >> 4) ^ table[remainder & 15U];
        remainder = (remainder >> 4) ^ table[remainder & 15U];
    }
    return ~remainder;
}
