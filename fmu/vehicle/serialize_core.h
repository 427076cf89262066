/* Fields of the core's structs to and from bytes, for every model of a vehicle. */
#ifndef LACONIC_FMU_SERIALIZE_CORE_H
#define LACONIC_FMU_SERIALIZE_CORE_H

#include "model_interface.h"

/* One field of a struct: an array of numbers, or one by its kind. */
#define SERIALIZE_ARRAY(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    fmu_stream_reals(s, (double *)&(of).member, sizeof(of).member / sizeof(double));
#define SERIALIZE(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) SERIALIZE_##KIND(s, &(of).member);
#define SERIALIZE_OWN(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) SERIALIZE_##KIND(s, &(of).own_##member);
#define SERIALIZE_REAL(stream, number) fmu_stream_reals(stream, number, 1)
#define SERIALIZE_INTEGER(stream, number) serialize_integer(stream, (int32_t *)(number)) /* or a kind of this size */
#define SERIALIZE_ABSENCE(stream, flag) fmu_stream_bool(stream, flag)
#define SERIALIZE_FLAG(stream, flag) fmu_stream_bool(stream, flag)
#define SERIALIZE_WHEEL_KIND(stream, kind) serialize_wheel_kind(stream, kind)

static inline void serialize_integer(fmu_stream *s, int32_t *number) {
    fmu_stream_i32(s, number, INT32_MIN, INT32_MAX);
}

static inline void serialize_wheel_kind(fmu_stream *s, laconic_wheel_kind *kind) {
    int32_t number = (int32_t)*kind;
    serialize_integer(s, &number);
    *kind = (laconic_wheel_kind)number;
}

static inline void serialize_sums(fmu_stream *s, laconic_sum *sums, size_t count) {
    for (size_t k = 0; k < count; k++) {
        fmu_stream_reals(s, &sums[k].value, 1);
        fmu_stream_reals(s, &sums[k].rest, 1);
    }
}

/* What a heading has not taken up is at most 1; not so NaN. */
static inline void serialize_heading(fmu_stream *s, laconic_heading *heading) {
    uint64_t fraction = heading->fraction;
    fmu_stream_i64(s, &heading->turns);
    fmu_stream_u64(s, &fraction);
    heading->fraction = fraction;
    fmu_stream_reals(s, &heading->rest, 1);
    if (s->from != NULL && !(heading->rest <= 1.0 && heading->rest >= -1.0)) s->failed = true;
}

#endif
