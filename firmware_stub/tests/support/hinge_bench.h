/* A tricycle for the bench's node: two fixed wheels behind, one under a hinge 1 m ahead of them. */
#ifndef HINGE_BENCH_H
#define HINGE_BENCH_H

/* clang-format off */
#include "node_internal.h" /* first: bench.h names a variable as its functions name an argument */
/* clang-format on */
#include "bench.h"
#include "unity.h"

#define STEP_S ((laconic_real)0.01)
#define NUMBER(field, item, value) {LACONIC_WIRE_FIELD_##field, item, (laconic_real)(value), false}
#define INTEGER(field, item, value) {LACONIC_WIRE_FIELD_##field, item, (laconic_real)(value), true}

typedef struct parameter {
    uint8_t field, item;
    laconic_real value;
    bool integer;
} parameter;

static const parameter common[] = {
    NUMBER(MASS, 0, 20),
    NUMBER(YAW_INERTIA, 0, 2),
    NUMBER(WHEEL_RADIUS, 0, 0.1),
    NUMBER(WHEEL_INERTIA, 0, 0.01),
    NUMBER(MOTOR_GAIN, 0, 0.5),
    NUMBER(MOTOR_DAMPING, 0, 1),
    INTEGER(METHOD, 0, 0),
    NUMBER(STEP, 0, STEP_S),
    INTEGER(WHEEL_COUNT, 0, 3),
    NUMBER(WHEEL_X, 1, 0),
    NUMBER(WHEEL_X, 2, 0),
    NUMBER(WHEEL_X, 3, 0),
    NUMBER(WHEEL_Y, 1, 0.2),
    NUMBER(WHEEL_Y, 2, -0.2),
    NUMBER(WHEEL_Y, 3, 0),
    INTEGER(BODY_COUNT, 0, 1),
    INTEGER(WHEEL_BODY, 3, 1),
    NUMBER(BODY_HINGE_X, 1, 1),
    NUMBER(BODY_HINGE_Y, 1, 0),
    NUMBER(BODY_MASS, 1, 1),
    NUMBER(BODY_YAW_INERTIA, 1, 0.1),
};
static const parameter prescribed = INTEGER(BODY_HINGE, 1, LACONIC_HINGE_PRESCRIBED);
static const parameter coordinated = INTEGER(BODY_HINGE, 1, LACONIC_HINGE_COORDINATED);
static const parameter ahead = NUMBER(TWIST, 1, 1);

static uint8_t data[LACONIC_FRAME_BYTES];

static inline uint8_t send_word(const parameter *it, uint8_t upper, uint32_t word) {
    const struct laconic_dbc_parameter_t frame = {
        .upper_half = upper, .field = it->field, .item = it->item, .value = word};
    laconic_dbc_parameter_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_PARAMETER, data);
    return bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
}

static inline uint8_t send_parameter(const parameter *it) {
    uint32_t words[sizeof(laconic_real) / 4];
    if (it->integer) return send_word(it, 0, (uint32_t)it->value);
    memcpy(words, &it->value, sizeof words);
    uint8_t status = 0;
    for (uint8_t k = 0; k < sizeof words / sizeof words[0]; k++) status = send_word(it, k, words[k]);
    return status;
}

static inline uint8_t commit(void) { return bench_commit(data); }

/* That wheel rolls along the first axis. */
static inline void send_rolling(uint8_t wheel) {
    const parameter kind = INTEGER(WHEEL_KIND, wheel, LACONIC_WHEEL_FIXED);
    const parameter axle = NUMBER(AXLE, wheel, -1.5707963267949);
    TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&kind));
    TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&axle));
}

static inline void begin_tricycle(const parameter *hinge) {
    bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0);
    for (size_t k = 0; k < sizeof common / sizeof common[0]; k++)
        TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&common[k]));
    for (uint8_t wheel = 1; wheel <= 3; wheel++) send_rolling(wheel);
    TEST_ASSERT_EQUAL_UINT8(0, send_parameter(hinge));
}

/* Bytes 5 and 6 of SELECT are those of hinges. */
static inline uint8_t select_bits(uint8_t send, uint8_t raw, uint8_t take, uint8_t of_hinges, uint8_t take_hinges) {
    uint8_t payload[LACONIC_FRAME_BYTES] = {0, 0, send, raw, take, of_hinges, take_hinges};
    bench_send(LACONIC_WIRE_SELECT, payload);
    return bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
}

static inline void steer(uint8_t page, int16_t first, int16_t second, int16_t third, bool sync) {
    const int16_t number[3] = {first, second, third};
    uint8_t payload[LACONIC_FRAME_BYTES] = {0, (uint8_t)(page << 5 | sync << 4)};
    for (int k = 0; k < 3; k++) put16(payload + 2 + 2 * k, (uint32_t)number[k]);
    bench_send(LACONIC_WIRE_STEERING, payload);
    bench_tick_lockstep();
}

static inline void load_tricycle(const parameter *hinge) {
    begin_tricycle(hinge);
    if (hinge == &coordinated) TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&ahead));
    TEST_ASSERT_EQUAL_UINT8(0, commit());
}

/* On ground with friction, with a servo on the hinge. */
static inline void begin_slipping(void) {
    const parameter more[] = {NUMBER(GROUND_FRICTION_COEFFICIENT, 0, 0.3),
                              INTEGER(BODY_HINGE, 1, LACONIC_HINGE_FREE),
                              NUMBER(SERVO_GAIN, 1, 60),
                              NUMBER(SERVO_DAMPING, 1, 2),
                              NUMBER(SERVO_LIMIT, 1, 3),
                              NUMBER(HINGE_DRY_FRICTION, 1, 0.01),
                              INTEGER(HINGE_HITCH, 1, 1),
                              NUMBER(SCRUB_RADIUS, 3, 0.01),
                              NUMBER(START_WHEEL_SPEED, 1, 5),
                              NUMBER(START_HINGE_ANGLE, 1, 0.2)};
    begin_tricycle(&prescribed);
    for (size_t k = 0; k < sizeof more / sizeof more[0]; k++) TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&more[k]));
}

static inline laconic_articulated_motion motion(void) {
    laconic_articulated_motion now;
    laconic_node_motion_of(&now, &node);
    return now;
}

/* The first hinge's rate; it is a difference of two yaw rates, which rounds. */
static inline void rate_is(laconic_real wanted) {
    const laconic_real off = motion().hinge_rate_rad_per_s[0] - wanted;
    TEST_ASSERT_TRUE(off < (laconic_real)1e-6 && off > (laconic_real)-1e-6);
}

#endif
