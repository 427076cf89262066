/* All that a vehicle consists of, to and from bytes. Prepared constants are not stored but prepared again: from the
 * same numbers come the same bits. */
#include "plant_api.h"

/* One field of a struct: an array of numbers, or one by its kind. */
#define TRANSFER_ARRAY(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    fmu_stream_reals(s, (of).member, sizeof(of).member / sizeof(double));
#define TRANSFER(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) TRANSFER_##KIND(s, &(of).member);
#define TRANSFER_REAL(stream, number) fmu_stream_reals(stream, number, 1)
#define TRANSFER_INTEGER(stream, number) fmu_stream_i32(stream, number, INT32_MIN, INT32_MAX)
#define TRANSFER_FLAG(stream, flag) fmu_stream_bool(stream, flag)
#define TRANSFER_WHEEL_KIND(stream, kind) transfer_kind(stream, kind)

static void transfer_kind(fmu_stream *s, laconic_wheel_kind *kind) {
    int32_t number = (int32_t)*kind;
    fmu_stream_i32(s, &number, INT32_MIN, INT32_MAX);
    *kind = (laconic_wheel_kind)number;
}

static void transfer_vehicle(fmu_stream *s, laconic_vehicle *v) {
    LACONIC_VEHICLE_FIELDS(TRANSFER, *v)
    LACONIC_PAYLOAD_FIELDS(TRANSFER, v->payload)
    fmu_stream_i32(s, &v->wheel_count, 0, LACONIC_MAX_WHEELS);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        LACONIC_WHEEL_FIELDS(TRANSFER, v->wheel[i])
    }
    fmu_stream_i32(s, &v->support_count, INT32_MIN, INT32_MAX);
    for (int32_t i = 0; i < LACONIC_MAX_SUPPORTS; i++) {
        LACONIC_SUPPORT_FIELDS(TRANSFER, v->support[i])
    }
}

static void transfer_start(fmu_stream *s, laconic_start *start) {
    LACONIC_START_ARRAY_FIELDS(TRANSFER_ARRAY, *start)
    LACONIC_START_FIELDS(TRANSFER, *start)
}

static void transfer_input(fmu_stream *s, laconic_input *u) {
    LACONIC_INPUT_ARRAY_FIELDS(TRANSFER_ARRAY, *u)
    LACONIC_INPUT_FIELDS(TRANSFER, *u)
}

static void transfer_sums(fmu_stream *s, laconic_sum *sums, size_t count) {
    for (size_t k = 0; k < count; k++) {
        fmu_stream_reals(s, &sums[k].value, 1);
        fmu_stream_reals(s, &sums[k].rest, 1);
    }
}

static void transfer_state(fmu_stream *s, laconic_state *state) {
    uint64_t fraction = state->heading.fraction;
    transfer_sums(s, state->zeta, 3);
    transfer_sums(s, &state->x_m, 1);
    transfer_sums(s, &state->y_m, 1);
    fmu_stream_i64(s, &state->heading.turns);
    fmu_stream_u64(s, &fraction);
    state->heading.fraction = fraction;
    fmu_stream_reals(s, &state->heading.rest, 1);
    transfer_sums(s, state->travel, 3);
    fmu_stream_reals(s, state->wheel_angle_set_rad, LACONIC_MAX_WHEELS);
}

static void transfer_continuous(fmu_stream *s, fmu_plant *p) {
    fmu_stream_reals(s, p->nu, 3);
    fmu_stream_reals(s, &p->x_m, 1);
    fmu_stream_reals(s, &p->y_m, 1);
    fmu_stream_reals(s, &p->heading_rad, 1);
    fmu_stream_reals(s, p->wheel_angle_rad, LACONIC_MAX_WHEELS);
}

/* Outputs are computed anew; the continuous states of Model Exchange lead and stay. */
static void transfer_stale(fmu_stream *s, fmu_plant *p) {
    bool follows = (p->stale & FMU_GROUP_STATE) != 0;
    fmu_stream_bool(s, &follows);
    if (s->from == NULL) return;
    p->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    if (p->continuous) p->stale &= ~FMU_GROUPS_OF_CONTINUOUS_STATES;
    if (p->continuous && follows) p->stale |= FMU_GROUP_STATE;
}

static int32_t method_number(const laconic_method *method) {
    for (int32_t number = 0; number < LACONIC_METHOD_COUNT; number++)
        if (laconic_method_by_number(number) == method) return number;
    return 0;
}

/* Vehicle, method and step in use → model, integrator and contact. */
static bool prepare_again(fmu_plant *p, int32_t number, double step_s) {
    laconic_plant *core = &p->core;
    const laconic_method *method = laconic_method_by_number(number);
    if (laconic_prepare(&core->model, &core->vehicle, NULL) != LACONIC_OK) return false;
    if (laconic_contact_prepare(&p->contact, &core->vehicle, NULL) != LACONIC_OK) return false;
    if (core->vehicle.wheel_count != p->vehicle.wheel_count) return false;
    if (laconic_integrator_prepare(&core->integrator, p->stand_in ? &laconic_exact_flow : method, &core->model, step_s,
                                   NULL) != LACONIC_OK)
        return false;
    core->integrator.method = method;
    return true;
}

static void transfer_core(fmu_stream *s, fmu_plant *p) {
    int32_t method = method_number(p->core.integrator.method);
    double step_s = p->core.integrator.step_s;
    transfer_vehicle(s, &p->core.vehicle);
    transfer_state(s, &p->core.state);
    fmu_stream_u64(s, &p->core.steps);
    fmu_stream_i32(s, &method, 0, LACONIC_METHOD_COUNT - 1);
    fmu_stream_reals(s, &step_s, 1);
    if (s->from == NULL || s->failed || p->start_needed) return;
    if (!prepare_again(p, method, step_s)) s->failed = true;
}

bool fmu_plant_transfer(fmu_stream *stream, fmu_plant *plant) {
    fmu_stream_bool(stream, &plant->start_needed);
    fmu_stream_bool(stream, &plant->change_needed);
    fmu_stream_bool(stream, &plant->states_changed);
    fmu_stream_bool(stream, &plant->continuous);
    fmu_stream_bool(stream, &plant->stand_in);
    fmu_stream_reals(stream, &plant->time_s, 1);
    transfer_vehicle(stream, &plant->vehicle);
    transfer_start(stream, &plant->start);
    fmu_stream_i32(stream, &plant->method, INT32_MIN, INT32_MAX);
    fmu_stream_reals(stream, &plant->step_s, 1);
    transfer_input(stream, &plant->input);
    fmu_stream_bool(stream, &plant->sloped);
    transfer_input(stream, &plant->slope);
    transfer_stale(stream, plant);
    transfer_continuous(stream, plant);
    transfer_core(stream, plant);
    return !stream->failed;
}
