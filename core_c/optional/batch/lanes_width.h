/* What batch.c and the lanes of each width tell each other. The structs of the core have other sizes in each, so only
 * numbers, rows of numbers and bytes cross. */
#ifndef LACONIC_LANES_WIDTH_H
#define LACONIC_LANES_WIDTH_H

#include "laconic/real.h"
#include "lanes_builds.h"

/* Numbers of a block's state, each a register of one number for each lane. */
enum {
    STATE_ZETA = 0,
    STATE_ZETA_REST = 3,
    STATE_TRAVEL = 6,
    STATE_TRAVEL_REST = 9,
    STATE_X = 12,
    STATE_X_REST,
    STATE_Y,
    STATE_Y_REST,
    STATE_FRACTION,
    STATE_HEADING_REST,
    STATE_TURNS, /* two registers in single precision */
    STATE_NUMBERS = 20
};

/* Rows of numbers, one number for each lane of the batch: what programs write, and what they read. */
enum {
    ROW_X = 0,
    ROW_Y,
    ROW_BODY_FORCE,
    ROW_BODY_MOMENT = 4,
    ROW_WORLD_FORCE = 5,
    ROW_WORLD_FORCE_POINT = 7,
    ROW_WHEELS = 9 /* for each wheel: voltage, axle torque, and the angle that was set */
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
#if LACONIC_WITH_EXPONENTIAL_GAUSS
#define LANES_COLLOCATION_MEMBERS(X) X(first_share) X(rest_share) X(collocation) X(collocation_of_rest)
#else
#define LANES_COLLOCATION_MEMBERS(X)
#endif

/* clang-format on */

/* How many numbers they are. */
#define LANES_CONSTANTS (35 + 3 * LACONIC_MAX_WHEELS + LACONIC_OWN_WHEELS + 83 + 182)

typedef enum lanes_method {
    LANES_RK4,
    LANES_EXPONENTIAL_KAHAN,
    LANES_EXPONENTIAL_KAHAN_4,
    LANES_EXACT_FLOW,
    LANES_EXACT_FLOW_4,
    LANES_TAYLOR_8,
    LANES_EXPONENTIAL_GAUSS_8, /* the last three, since their stretches count as further methods: LANES_WAYS */
    LANES_AUTO_SLOW,           /* auto_slow and auto_fast of auto.c: the same steps, and lanes for which others are */
    LANES_AUTO_FAST,           /* taken go alone */
    LANES_METHOD_COUNT
} lanes_method;

/* Of lanes that each step alone, by a method that registers do not know. */
#define LANES_NO_METHOD LANES_METHOD_COUNT

/* What all lanes of a block share. */
typedef struct lanes_kind {
    lanes_method method;
    int32_t wheel_count, stretches;
    bool has_rest, sloped, stiff;
} lanes_kind;

/* Some lanes that step together: in each register of `state` one number of each. */
typedef struct laconic_batch_block {
    void *model, *integrator; /* of a width; set by its place()                            */
    unsigned char *state;     /* STATE_NUMBERS registers                                   */
    unsigned char *rows;      /* of the batch                                              */
    size_t row_bytes;         /* from row to row                                           */
    const int32_t *lanes;     /* of the batch: its own, and where it lacks some, the first */
    lanes_method method;
    int32_t way; /* of its kinds: lanes of one way can share a block                      */
    int32_t count, wheel_count;
    bool in_a_row;       /* its lanes follow each other, and rows have numbers for those that it lacks */
    bool has_refused;    /* some lane's status is not OK                                               */
    bool near_last_turn; /* some lane's heading may be within 2⁶¹ turns of the last that is counted    */
    uint32_t stopped;    /* in a run, a bit for each lane that was refused                             */
} laconic_batch_block;

/* Who takes the step of those lanes of a block that cannot go with the others, a bit for each; `after`: the steps of
 * the run that come after it. Returns those that were refused. */
typedef struct lanes_alone {
    uint32_t (*step)(void *context, laconic_batch_block *block, uint32_t which, uint64_t after);
    void *context;
} lanes_alone;

/* Lanes of one width, compiled for the processors that have it. */
typedef struct lanes_width {
    int32_t lanes;
    size_t model_bytes, integrator_bytes;
    /* Sets one lane of a block's model and integrator, and what all of them share. */
    void (*place)(const laconic_batch_block *block, int32_t lane, lanes_kind kind, const laconic_number *constants);
    /* Takes steps of blocks that follow each other and have this method. Lanes that stopped stay. */
    void (*run[LANES_METHOD_COUNT])(laconic_batch_block *blocks, int32_t count, uint64_t steps,
                                    const lanes_alone *alone);
} lanes_width;

extern const lanes_width laconic_lanes_of_16, laconic_lanes_of_32, laconic_lanes_of_64;

#endif
