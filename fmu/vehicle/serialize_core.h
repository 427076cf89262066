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

#ifdef LACONIC_ARTICULATED_H /* of models that include it: vehicles with hinges */

static inline void serialize_hinged_vehicle(fmu_stream *s, laconic_articulated_vehicle *v) {
    laconic_vehicle *base = &v->base;
    LACONIC_VEHICLE_FIELDS(SERIALIZE, *base)
    LACONIC_PAYLOAD_FIELDS(SERIALIZE, base->payload)
    LACONIC_GROUND_FIELDS(SERIALIZE, base->ground)
    fmu_stream_i32(s, &base->wheel_count, 0, LACONIC_MAX_WHEELS);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        LACONIC_WHEEL_FIELDS(SERIALIZE, base->wheel[i])
        LACONIC_OWN_WHEEL_FIELDS(SERIALIZE_OWN, base->wheel[i])
        serialize_integer(s, &v->wheel_body[i]);
    }
    serialize_integer(s, &base->support_count);
    for (int32_t i = 0; i < LACONIC_MAX_SUPPORTS; i++) {
        LACONIC_SUPPORT_FIELDS(SERIALIZE, base->support[i])
    }
    fmu_stream_i32(s, &v->body_count, 0, LACONIC_MAX_BODIES);
    for (int32_t b = 0; b < LACONIC_MAX_BODIES; b++) {
        LACONIC_BODY_FIELDS(SERIALIZE, v->body[b])
    }
}

static inline void serialize_hinged_start(fmu_stream *s, laconic_articulated_start *start) {
    LACONIC_START_FIELDS(SERIALIZE, *start)
    LACONIC_HINGE_START_FIELDS(SERIALIZE_ARRAY, *start)
}

static inline void serialize_hinged_input(fmu_stream *s, laconic_articulated_input *u) {
    LACONIC_INPUT_ARRAY_FIELDS(SERIALIZE_ARRAY, u->base)
    LACONIC_INPUT_FIELDS(SERIALIZE, u->base)
    LACONIC_HINGE_INPUT_FIELDS(SERIALIZE_ARRAY, *u)
}

#endif

#endif
