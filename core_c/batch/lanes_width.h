/* What batch.c and the lanes of each width tell each other. The structs of the core have other sizes in each, so only
 * numbers, rows of numbers and bytes cross. */
#ifndef LACONIC_LANES_WIDTH_H
#define LACONIC_LANES_WIDTH_H

#include "laconic/real.h"
#include "lanes_builds.h"

/* Rows of numbers, one number for each lane of the batch. */
enum {
    ROW_ZETA = 0,
    ROW_ZETA_REST = 3,
    ROW_TRAVEL = 6,
    ROW_TRAVEL_REST = 9,
    ROW_X = 12,
    ROW_X_REST,
    ROW_Y,
    ROW_Y_REST,
    ROW_FRACTION,
    ROW_HEADING_REST,
    ROW_TURNS, /* two rows in single precision */
    ROW_BODY_FORCE = 20,
    ROW_BODY_MOMENT = 22,
    ROW_WORLD_FORCE = 23,
    ROW_WORLD_FORCE_POINT = 25,
    ROW_WHEELS = 27 /* for each wheel: voltage, axle torque, and the angle that was set */
};

#define ROW_VOLTAGE(wheel) (ROW_WHEELS + 3 * (wheel))
#define ROW_AXLE_TORQUE(wheel) (ROW_WHEELS + 3 * (wheel) + 1)
#define ROW_WHEEL_ANGLE_SET(wheel) (ROW_WHEELS + 3 * (wheel) + 2)

/* clang-format off */

/* The members of laconic_model and laconic_integrator that a step reads, in this order. */
#define LANES_MODEL_MEMBERS(X) \
    X(nu_of_zeta) X(gyro) X(gyro_square) X(spin_gain) X(spin_curve) X(decay_per_s) X(velocity_of_zeta) \
    X(yaw_rate_of_zeta) X(wheel_of_zeta) X(torque_scale) X(voltage_scale) X(yaw_scale) X(slope_force_N)
#define LANES_INTEGRATOR_MEMBERS(X) X(step_s) X(decay) X(gyro_limit)

/* clang-format on */

/* How many numbers they are. */
#define LANES_CONSTANTS (35 + 3 * LACONIC_MAX_WHEELS + LACONIC_OWN_WHEELS + 83)

typedef enum lanes_method {
    LANES_RK4,
    LANES_EXPONENTIAL_KAHAN,
    LANES_EXPONENTIAL_KAHAN_4,
    LANES_EXACT_FLOW,
    LANES_EXACT_FLOW_4,
    LANES_TAYLOR_8,
    LANES_AUTO_SLOW, /* auto_slow and auto_fast of auto.c */
    LANES_AUTO_FAST,
    LANES_METHOD_COUNT
} lanes_method;

/* What all lanes of a block share. */
typedef struct lanes_kind {
    lanes_method method;
    int32_t wheel_count;
    bool sloped, stiff;
} lanes_kind;

typedef struct lanes_block {
    void *model, *integrator; /* of a width; set by its place()           */
    unsigned char *rows;      /* the first row            */
    size_t row_bytes;         /* from row to row          */
    int32_t first;            /* lane of the rows         */
} lanes_block;

/* Lanes of one width, compiled for the processors that have it. */
typedef struct lanes_width {
    int32_t lanes;
    size_t model_bytes, integrator_bytes;
    /* Sets one lane of a block's model and integrator, and what all of them share. */
    void (*place)(const lanes_block *block, int32_t lane, lanes_kind kind, const laconic_number *constants);
    /* Takes steps until all are taken or some lane cannot take its step as the others do. Returns the number of steps
     * begun; the lanes of `apart`, a bit for each, are still before the last of them. Lanes of `stopped` stay. */
    uint64_t (*run[LANES_METHOD_COUNT])(const lanes_block *block, uint64_t steps, uint32_t stopped, uint32_t *apart);
} lanes_width;

extern const lanes_width laconic_lanes_of_16, laconic_lanes_of_32, laconic_lanes_of_64;

#endif
