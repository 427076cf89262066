/* Numbers bit for bit over the bus: inputs in, outputs out, as a stream of little-endian IEEE numbers. */
#ifndef LACONIC_NODE_RAW_FRAMES_H
#define LACONIC_NODE_RAW_FRAMES_H

#include "laconic/laconic.h"
#include "laconic_drives/settings.h" /* LACONIC_NODE_WITH_DRIVES, LACONIC_NODE_DRIVES_ONLY */
#include "laconic_wire.h"            /* LACONIC_NODE_WITH_SENSORS, LACONIC_NODE_WITH_HINGES */
#if LACONIC_NODE_WITH_HINGES
#include "laconic/articulated.h"
#endif

/* Bits of SELECT for the numbers in RAW_INPUT; those of one input follow in this order. */
#define LACONIC_RAW_VOLTAGE 1U     /* N numbers                             */
#define LACONIC_RAW_AXLE_TORQUE 2U /* N numbers                             */
#define LACONIC_RAW_BODY_WRENCH 4U /* force ξ, η, moment                    */
#define LACONIC_RAW_WORLD_FORCE 8U /* force X, Y, point ξ, η                */
#define LACONIC_RAW_SAMPLED 128U   /* three inputs: start, middle, end      */
#define LACONIC_RAW_TAKES 0x8FU    /* all of these                          */

/* The same for hinges, H of them; their numbers follow those of the input. Sampled inputs are two: start and end. */
#define LACONIC_RAW_HINGE_VOLTAGE 1U   /* H numbers                             */
#define LACONIC_RAW_HINGE_TORQUE 2U    /* H numbers                             */
#define LACONIC_RAW_STEERING_RATE 4U   /* H numbers: rates of prescribed hinges */
#define LACONIC_RAW_TWIST 8U           /* 3 numbers                             */
#define LACONIC_RAW_STEERING_ANGLE 16U /* H numbers: of servos and loops, where wheels may slip */
#define LACONIC_RAW_HINGE_TAKES 31U    /* all of these                          */

/* Bits of SELECT for the numbers in RAW_OUTPUT, which follow in this order. */
#define LACONIC_RAW_NU 1U          /* 3; neither these nor the energy in images that play drives alone */
#define LACONIC_RAW_POSE 2U        /* x, y, heading (unwrapped) */
#define LACONIC_RAW_WHEEL_SPEED 4U /* N */
#define LACONIC_RAW_WHEEL_ANGLE 8U /* N */
#define LACONIC_RAW_ENERGY 16U     /* 1 */
#define LACONIC_RAW_IMU 32U /* 5: acceleration of the body's origin ξ, η; the IMU's acceleration x, y; its yaw rate */
#define LACONIC_RAW_ENCODER 64U      /* N: count as shown, 0 where a wheel has none */
#define LACONIC_RAW_HELD_TORQUE 128U /* N: axle torque besides the motor's that was held in the last step */

/* The same for a vehicle with hinges, behind all others. */
#define LACONIC_RAW_VELOCITY 1U    /* 3: of S_0 ahead and to the left, yaw rate */
#define LACONIC_RAW_HINGE_ANGLE 2U /* H, unwrapped */
#define LACONIC_RAW_HINGE_RATE 4U  /* H */

/* Numbers of one RAW_OUTPUT at most. */
#define LACONIC_RAW_OUTPUTS \
    ((LACONIC_NODE_DRIVES_ONLY ? 3 : 7) + 2 * LACONIC_MAX_WHEELS + LACONIC_NODE_WITH_DRIVES * LACONIC_MAX_WHEELS + \
     LACONIC_NODE_WITH_SENSORS * (5 + LACONIC_MAX_WHEELS) + LACONIC_NODE_WITH_HINGES * (3 + 2 * LACONIC_MAX_BODIES))

typedef struct laconic_raw_input {
    uint8_t take;      /* mask                                                */
    uint8_t filled;    /* bytes of `number` that have come                    */
    uint16_t position; /* numbers stored since the last SYNC                  */
    bool complete;     /* all of them have come since the last SYNC           */
    bool broken;       /* a segment was out of order: only segment 0 mends it */
    uint8_t segment;   /* next one expected                                   */
    uint16_t frames;   /* accepted since the last SYNC                        */
    uint8_t number[sizeof(laconic_real)];
#if LACONIC_NODE_WITH_HINGES
    uint8_t take_hinges;               /* mask                                */
    int32_t hinge_count;               /* 0: a vehicle without hinges         */
    laconic_articulated_input *hinged; /* two, for the numbers of hinges      */
    laconic_real *angle_rad;           /* NULL: wheels do not slip            */
#endif
} laconic_raw_input;

/* Drops the numbers since the last SYNC. */
void laconic_raw_restart(laconic_raw_input *raw);

/* Accepts the bytes of one segment. False iff it is out of order or one too many; then only segment 0 is accepted
 * next. */
bool laconic_raw_take(laconic_raw_input *raw, laconic_input input[3], int32_t wheel_count, uint8_t segment,
                      uint8_t segment_mask, const uint8_t *bytes, uint8_t count);

/* Whether a SYNC with that input_frames may use the inputs: none or all of their numbers have come, in so many
 * frames. */
bool laconic_raw_is_whole(const laconic_raw_input *raw, uint16_t frames);

typedef struct laconic_raw_output {
    uint8_t send;      /* mask                                                */
    uint16_t position; /* next byte                                           */
    uint16_t size;     /* bytes                                               */
    uint8_t segment;
    laconic_real number[LACONIC_RAW_OUTPUTS];
#if LACONIC_NODE_WITH_HINGES
    uint8_t send_hinges; /* mask */
#endif
} laconic_raw_output;

/* Reads the chosen outputs of the plant, all of one instant, and begins at the first byte. `held`: the input of the
 * step that has led there. `sensed`: what sensors show then; read only where it is chosen. */
void laconic_raw_collect(laconic_raw_output *raw, const laconic_plant *plant, const laconic_input *held,
                         const laconic_sensor_outputs *sensed);

#if LACONIC_NODE_WITH_HINGES
/* The same for a vehicle with hinges. */
void laconic_raw_collect_hinges(laconic_raw_output *raw, const laconic_articulated_motion *motion, int32_t wheel_count,
                                int32_t body_count, const laconic_input *held);
#endif

/* Copies the next bytes, at most `room`, and fills up with zeros; false iff these were the last. */
bool laconic_raw_give(laconic_raw_output *raw, uint8_t *bytes, uint8_t room);

#endif
