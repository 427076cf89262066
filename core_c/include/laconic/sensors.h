/* Sensors that a robot carries: an inertial measurement unit (IMU) at a place of the body, and an incremental encoder
 * at each wheel. Part of laconic.h; docs/sensors.md derives what they show.
 *
 *     settings --check--> start --> laconic_sensors_run (steps of the plant) --> read
 *
 * A sensor never changes the motion: a plant that is watched by sensors takes the same steps, bit for bit. All of them
 * are plain data: copy a laconic_sensors with its plant to save and restore it, noise included.
 *
 * Noise  a pure function of the seed and of the number of the step (plant->steps). So two runs with the same seed have
 *        the same noise, however their steps are grouped, and no generator has a state of its own.
 * Time   the IMU samples once a step of the core, at its end, with the input that acted over that step: a command shows
 *        in it one step later. At the start no step has been taken, and the sample is that of a plant without input. */
#ifndef LACONIC_SENSORS_H
#define LACONIC_SENSORS_H

#include "laconic/internals.h"
#include "laconic/real.h"
#include "laconic/status.h"
#include "laconic/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

struct laconic_plant;
struct laconic_refusal;

#ifndef LACONIC_IMU_MAX_DELAY
#define LACONIC_IMU_MAX_DELAY 64 /* steps; each needs space for three numbers */
#endif
#if LACONIC_IMU_MAX_DELAY < 0 || LACONIC_IMU_MAX_DELAY > 4096
#error "laconic: LACONIC_IMU_MAX_DELAY must be from 0 to 4096"
#endif

/* ------------------------------------------------------------------------------- settings -- */

/* All zero: an ideal IMU at the body's origin, along the body's axes. A sample is
 *     (1 + scale error) · true value + bias + noise,     then held within ± range,
 * and is shown `delay_steps` steps after it was taken. The noise is white. Its density is the one-sided one of data
 * sheets. A sample's standard deviation is the density times the square root of half the sample rate, 1/(2 step_s).
 * The noise of a motion therefore does not depend on the step. */
typedef struct laconic_imu_settings {
    laconic_real x_m, y_m;    /* where it is, in the body frame                                          */
    laconic_real heading_rad; /* of its x axis in the body frame; its y axis is to the left of it         */
    laconic_real acceleration_scale_error[2];
    laconic_real acceleration_bias_m_per_s2[2];
    laconic_real acceleration_noise_m_per_s2_per_sqrt_Hz; /* of either axis                             */
    laconic_real acceleration_range_m_per_s2;             /* 0: none                                    */
    laconic_real yaw_rate_scale_error;
    laconic_real yaw_rate_bias_rad_per_s;
    laconic_real yaw_rate_noise_rad_per_s_per_sqrt_Hz;
    laconic_real yaw_rate_range_rad_per_s; /* 0: none                                                   */
    int32_t delay_steps;                   /* 0 … LACONIC_IMU_MAX_DELAY                                 */
    int32_t seed;                          /* of the noise; every number is one                         */
} laconic_imu_settings;

/* The encoder of one wheel. All zero: the wheel has none. */
typedef struct laconic_encoder_settings {
    int32_t counts_per_turn; /* of the encoder's shaft, all edges counted; 0: no encoder                  */
    laconic_real gear_ratio; /* turns of that shaft for one of the wheel; below 0: it counts backwards; 0: 1 */
} laconic_encoder_settings;

/* All zero: the sensors of a scene without any. */
typedef struct laconic_sensor_settings {
    laconic_imu_settings imu;
    int32_t encoder_wrap; /* encoders show 0 … wrap − 1 and begin again; 0: the int32_t itself, which also wraps */
    laconic_encoder_settings encoder[LACONIC_MAX_WHEELS];
} laconic_sensor_settings;

/* Rows as in vehicle.h: X(of, number, IDENTIFIER, member, name, KIND, RULE, NEED). A new number changes four files, as
 * one of vehicle.h does. laconic_field_name(), laconic_field_path() and laconic_field_traits_of() know them. */
/* clang-format off */
#define LACONIC_IMU_FIELDS(X, of) \
    X(of, 80, IMU_X,       x_m,         imu_x_m,         REAL, FINITE, NEVER) \
    X(of, 81, IMU_Y,       y_m,         imu_y_m,         REAL, FINITE, NEVER) \
    X(of, 82, IMU_HEADING, heading_rad, imu_heading_rad, REAL, ANGLE,  NEVER) \
    X(of, 85, IMU_ACCELERATION_NOISE, acceleration_noise_m_per_s2_per_sqrt_Hz, \
      imu_acceleration_noise_m_per_s2_per_sqrt_Hz, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 86, IMU_ACCELERATION_RANGE, acceleration_range_m_per_s2, imu_acceleration_range_m_per_s2, REAL, \
      NOT_NEGATIVE, NEVER) \
    X(of, 87, IMU_YAW_RATE_SCALE_ERROR, yaw_rate_scale_error, imu_yaw_rate_scale_error, REAL, FINITE, NEVER) \
    X(of, 88, IMU_YAW_RATE_BIAS, yaw_rate_bias_rad_per_s, imu_yaw_rate_bias_rad_per_s, REAL, FINITE, NEVER) \
    X(of, 89, IMU_YAW_RATE_NOISE, yaw_rate_noise_rad_per_s_per_sqrt_Hz, imu_yaw_rate_noise_rad_per_s_per_sqrt_Hz, \
      REAL, NOT_NEGATIVE, NEVER) \
    X(of, 90, IMU_YAW_RATE_RANGE, yaw_rate_range_rad_per_s, imu_yaw_rate_range_rad_per_s, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 91, IMU_DELAY, delay_steps, imu_delay_steps, INTEGER, NOT_NEGATIVE, NEVER) \
    X(of, 92, IMU_SEED,  seed,        imu_seed,        INTEGER, UNCHECKED,    NEVER)

/* Arrays of two numbers: along the IMU's x and y axis. */
#define LACONIC_IMU_ARRAY_FIELDS(X, of) \
    X(of, 83, IMU_ACCELERATION_SCALE_ERROR, acceleration_scale_error, imu_acceleration_scale_error, REAL, FINITE, \
      NEVER) \
    X(of, 84, IMU_ACCELERATION_BIAS, acceleration_bias_m_per_s2, imu_acceleration_bias_m_per_s2, REAL, FINITE, NEVER)

#define LACONIC_ENCODER_FIELDS(X, of) \
    X(of, 95, WHEEL_ENCODER_WRAP, wrap, encoder_wrap, INTEGER, NOT_NEGATIVE, NEVER)

/* One row for each wheel. */
#define LACONIC_WHEEL_ENCODER_FIELDS(X, of) \
    X(of, 93, WHEEL_ENCODER_COUNTS, counts_per_turn, encoder_counts_per_turn, INTEGER, NOT_NEGATIVE, NEVER) \
    X(of, 94, WHEEL_ENCODER_GEAR_RATIO, gear_ratio, encoder_gear_ratio, REAL, FINITE, NEVER)

#define LACONIC_SENSOR_FIELDS(X) \
    LACONIC_IMU_FIELDS(X, IMU) LACONIC_IMU_ARRAY_FIELDS(X, IMU_ARRAY) LACONIC_ENCODER_FIELDS(X, ENCODER) \
    LACONIC_WHEEL_ENCODER_FIELDS(X, WHEEL_ENCODER)
/* clang-format on */

#define LACONIC_SENSOR_FIELD_NUMBER(of, number, IDENTIFIER, ...) LACONIC_SENSOR_FIELD_##IDENTIFIER = number,

/* Numbers of a refusal's field in addition to those that laconic_field names; converted to it they keep their
 * values. */
typedef enum laconic_sensor_field {
    LACONIC_SENSOR_FIELDS(LACONIC_SENSOR_FIELD_NUMBER) LACONIC_SENSOR_FIELD_COUNT = 96
} laconic_sensor_field;

/* Returns OK iff every number is usable for a vehicle with this number of wheels. Otherwise it refuses the first
 * that is not, by the rules of the rows. Refuses OVERFLOW beyond ± 10¹⁵, and ABOVE_LIMIT for a delay beyond
 * LACONIC_IMU_MAX_DELAY and for the counts of a wheel that the vehicle does not have (limit 0). */
laconic_status laconic_sensor_settings_check(const laconic_sensor_settings *settings, int32_t wheel_count,
                                             struct laconic_refusal *why);

/* ------------------------------------------------------------------------------ an encoder -- */

/* Counts since the start, not wrapped, and the share of a count beyond them, 0 … below 1, which no encoder shows. */
typedef struct laconic_encoder {
    int64_t count;
    laconic_real rest;
} laconic_encoder;

/* Turns the encoder with its wheel. Whole counts and the share are added apart, so that no number of turns costs
 * resolution. False, and unchanged, iff that is NaN or beyond ± 2147483520 counts, the last whole number of 32 bits
 * that single precision has. */
bool laconic_encoder_turn(laconic_encoder *encoder, const laconic_encoder_settings *settings,
                          laconic_real wheel_turned_rad);

/* The place within one turn of its shaft: 0 … counts_per_turn − 1; the index pulse is at 0. */
int32_t laconic_encoder_place(const laconic_encoder *encoder, int32_t counts_per_turn);

/* How often the shaft has passed the index forwards, less how often backwards: count/counts_per_turn, rounded down. */
int64_t laconic_encoder_turns(const laconic_encoder *encoder, int32_t counts_per_turn);

/* Returns the encoder's reading: the count modulo `wrap`, or for 0 the lower 32 bits of the count as an int32_t. */
int32_t laconic_encoder_shown(const laconic_encoder *encoder, int32_t wrap);

#if LACONIC_MAX_WHEELS > 3
#define LACONIC_TURNED_SUMS LACONIC_MAX_WHEELS
#else
#define LACONIC_TURNED_SUMS 3
#endif

/* How far the wheels have turned, as the plant keeps it: on ideal ground three sums of which each angle is a
 * combination, else one a wheel. */
typedef struct laconic_odometer {
    laconic_sum sum[LACONIC_TURNED_SUMS];
} laconic_odometer;

void laconic_odometer_of(laconic_odometer *now, const struct laconic_plant *plant);

/* How far a wheel has turned since `before` [rad], with the parts that the difference of two angles would lose after
 * many turns. The vehicle must be the same. */
laconic_real laconic_wheel_turned_rad(const struct laconic_plant *plant, const laconic_odometer *before, int32_t wheel);

/* ----------------------------------------------------------------------------------- noise -- */

/* Two independent deviates of the standard normal distribution for each seed, stream and index: the same bits on every
 * platform. Any two of the three that differ in one number are independent of each other. */
void laconic_normal_pair(laconic_real pair[2], uint64_t seed, uint32_t stream, uint64_t index);

/* ------------------------------------------------------------------------- all of a vehicle -- */

/* Returns the reading of an ideal IMU at one moment, in its own axes. */
typedef struct laconic_imu_sample {
    laconic_real specific_force_m_per_s2[2]; /* acceleration less that of gravity */
    laconic_real yaw_rate_rad_per_s;
} laconic_imu_sample;

/* Settings and state of all sensors of one vehicle. */
typedef struct laconic_sensors {
    laconic_sensor_settings settings;
    laconic_encoder encoder[LACONIC_MAX_WHEELS];
    laconic_real acceleration_m_per_s2[2]; /* of the body's origin, mean over the last step: where the vehicle has
                                              friction; else 0 */
    uint64_t newest;                       /* number of the newest sample: plant->steps */
    laconic_imu_sample sample[LACONIC_IMU_MAX_DELAY + 1]; /* number n at n modulo their number */
} laconic_sensors;

/* Everything that the sensors show at one moment; every member is a number of the scalar type. */
typedef struct laconic_sensor_outputs {
    laconic_real acceleration_body_m_per_s2[2]; /* laconic_acceleration_body()                              */
    laconic_real imu_acceleration_m_per_s2[2];  /* its x and y axis: specific force, so a slope shows at rest */
    laconic_real imu_yaw_rate_rad_per_s;
    laconic_real encoder_count[LACONIC_MAX_WHEELS]; /* 0 without an encoder; in single exact up to 2^24: wrap earlier */
} laconic_sensor_outputs;

/* Starts sensors as after power-up, next to a plant in its present state. Encoders are at 0, and the IMU's delay
 * line holds the sample of this moment. Refuses as laconic_sensor_settings_check() does, and changes nothing then. */
laconic_status laconic_sensors_start(laconic_sensors *sensors, const laconic_sensor_settings *settings,
                                     const struct laconic_plant *plant, struct laconic_refusal *why);

/* laconic_plant_run() and laconic_plant_run_sampled() with sensors that watch. Steps are taken one by one where a
 * sensor must see each. In addition to their refusals, OVERFLOW if an encoder was turned by more than 2147483520
 * counts in a step (WHEEL_ENCODER_COUNTS, item: the wheel). Also OVERFLOW if a sample is beyond ± 10¹⁵ m/s² (IMU_X
 * or IMU_Y, the farther). The step has been taken then. */
laconic_status laconic_sensors_run(laconic_sensors *sensors, struct laconic_plant *plant, const laconic_input *held,
                                   uint64_t steps, struct laconic_refusal *why);
laconic_status laconic_sensors_run_sampled(laconic_sensors *sensors, struct laconic_plant *plant,
                                           const laconic_input samples[3], struct laconic_refusal *why);

/* For callers that step the plant themselves: before and after each step. */
typedef struct laconic_sensor_moment {
    laconic_odometer odometer;
    laconic_real velocity_m_per_s[2], yaw_rate_rad_per_s; /* of S, body axes */
} laconic_sensor_moment;

void laconic_sensors_before(laconic_sensor_moment *before, const struct laconic_plant *plant);
laconic_status laconic_sensors_after(laconic_sensors *sensors, const struct laconic_plant *plant,
                                     const laconic_input *held, const laconic_sensor_moment *before,
                                     struct laconic_refusal *why);

/* Inertial acceleration of the body's origin in body axes, v' + ω × v. On ideal ground exactly that of this moment
 * with this input. With friction it is the mean over the last step, because contact forces exist for a complete
 * step: the change of velocity over it, in the axes of its middle (before the first step as if the motion had
 * continued; `sensors` may be NULL only on ideal ground). */
void laconic_acceleration_body(laconic_real acceleration_m_per_s2[2], const laconic_sensors *sensors,
                               const struct laconic_plant *plant, const laconic_input *input);

/* Returns the IMU's reading: the sample of delay_steps ago with its errors. */
void laconic_imu_read(const laconic_sensors *sensors, laconic_real step_s, laconic_real acceleration_m_per_s2[2],
                      laconic_real *yaw_rate_rad_per_s);

/* Everything at once. */
void laconic_sensors_read(laconic_sensor_outputs *outputs, const laconic_sensors *sensors,
                          const struct laconic_plant *plant, const laconic_input *input);

/* ------------------------------------------------------------ for outer integrators (Model Exchange) -- */

struct laconic_model;

/* The same acceleration of the origin, and what an ideal IMU at its place feels, from ν and its derivative. */
void laconic_acceleration_of_rates(laconic_real acceleration_m_per_s2[2], const struct laconic_model *model,
                                   const laconic_real nu_rad_per_s[3], const laconic_real nu_rad_per_s2[3]);
void laconic_imu_feel(laconic_imu_sample *sample, const laconic_imu_settings *imu, const struct laconic_model *model,
                      const laconic_real nu_rad_per_s[3], const laconic_real nu_rad_per_s2[3],
                      laconic_real heading_rad);

/* Returns the directional derivative of that acceleration on ideal ground, along a change of ν and the change of ν'
 * that laconic_derivative_tangent gives for it. ν and its change are first projected onto the allowed motions. */
void laconic_acceleration_tangent(laconic_real change[2], const struct laconic_model *model,
                                  const laconic_real nu_rad_per_s[3], const laconic_real by_nu_rad_per_s[3],
                                  const laconic_real by_nu_rad_per_s2[3]);

/* A true sample with the errors of an IMU; `number` and step_s choose the noise and its size. */
void laconic_imu_show(const laconic_imu_settings *imu, const laconic_imu_sample *sample, uint64_t number,
                      laconic_real step_s, laconic_real acceleration_m_per_s2[2], laconic_real *yaw_rate_rad_per_s);

#ifdef __cplusplus
}
#endif
#endif
