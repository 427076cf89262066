/* Extended Kalman filter: where a robot is and how it moves, from its voltages, wheel encoders, a gyro and fixes of its
 * pose. It predicts by laconic_step() and the exact derivatives of that step. It costs a step's Jacobian and some small
 * matrices, in either scalar type. docs/control.md shows it at work.
 *
 *     settings --start--> filter --predict--> (a step) --encoders, yaw_rate, fix--> state, covariance
 *
 * Optional: a program that calls nothing of it carries nothing of it. Not for vehicles with friction, whose step is not
 * smooth.
 *
 * Estimate   (ν, x, y, θ) and, where it is asked for, the bias of the gyro. Errors are kept in the coordinates ζ of
 *            laconic_model, in which constraints hold by themselves, and beside them those of ∫ζ dt, by which encoders
 *            count: their rounding to counts does not add up.
 * Covariance as U D Uᵀ, with a unit triangle U and D ≥ 0 (Thornton's prediction, Bierman's update): symmetric and
 *            positive whatever is rounded, so that single precision is enough. No square root is taken.
 * Noise      of voltages, forces and slip is white and given as data sheets give it, by one-sided densities: a number
 *            held over a step varies by the density times √(1/(2 step_s)), so the filter's trust does not depend on the
 *            step. Errors of readings are those of one reading: its standard deviation.
 * Memory     the caller owns the struct; no heap. laconic_filter is plain data: copy it before a reading, and copy it
 *            back where the innovation tells that the reading is not to be believed.
 * Errors     a call that is refused changes nothing in the estimate.
 * Cost       docs/control.md, in instructions of a Cortex-M4F. A prediction needs the stack of a Jacobian
 *            (derivatives.h) and half a KB; on a Cortex-M4F, single, 2.3 KB with an explicit method of fourth order
 *            and 3.6 KB with what auto takes.
 * Links      every method with its derivatives, since auto may take most of them: some 110 KB of flash there.
 *            laconic_filter_predict_by() links one: 21 KB with such a method, 60 KB with what auto takes. */
#ifndef LACONIC_FILTER_H
#define LACONIC_FILTER_H

#include "laconic/derivatives.h"

#ifdef __cplusplus
extern "C" {
#endif

/* --------------------------------------------------------------------------------- settings -- */

/* All zero: a filter that believes its start and the model. Every number is ≥ 0. */
typedef struct laconic_filter_settings {
    /* further causes in addition to the input, as one-sided densities */
    laconic_real voltage_noise_V_per_sqrt_Hz;    /* of each motor's voltage                                 */
    laconic_real force_noise_N_per_sqrt_Hz;      /* at S, along either body axis                            */
    laconic_real moment_noise_Nm_per_sqrt_Hz;    /* about S                                                 */
    laconic_real slip_noise_m_per_s_per_sqrt_Hz; /* of the body over what its wheels roll, either axis      */
    laconic_real yaw_slip_noise_rad_per_s_per_sqrt_Hz;
    laconic_real bias_noise_rad_per_s2_per_sqrt_Hz; /* by which the gyro's bias drifts                       */
    /* how well the start is known: standard deviations */
    laconic_real nu_std_rad_per_s[3];
    laconic_real position_std_m; /* of x and of y */
    laconic_real heading_std_rad;
    laconic_real bias_std_rad_per_s; /* this and its drift 0: no bias is estimated */
    /* how well instruments read: standard deviations of one reading. White noise on top of rounding to counts is
     * √(1/6) of a count, where the place between two counts at the start is also not known. */
    laconic_real encoder_std_rad[LACONIC_MAX_WHEELS]; /* of the wheel's angle; 0: that wheel has no encoder */
    laconic_real yaw_rate_std_rad_per_s;              /* 0: without a gyro                                   */
} laconic_filter_settings;

/* ----------------------------------------------------------------------------------- filter -- */

/* Errors that a filter may keep: ∫ζ dt (3), x, y, θ, bias, ζ (3); and columns of noise in addition to them. */
#define LACONIC_FILTER_ERRORS 10
#define LACONIC_FILTER_NOISES 7

/* U D Uᵀ of a covariance, of its first `count` rows. */
typedef struct laconic_factors {
    laconic_real upper[LACONIC_FILTER_ERRORS][LACONIC_FILTER_ERRORS]; /* ones on the diagonal, zeros below it */
    laconic_real diagonal[LACONIC_FILTER_ERRORS];
} laconic_factors;

/* Read `state` and `bias_rad_per_s`; the rest belongs to the filter. Wheel angles of the state are those since its
 * encoder was last read, and of a wheel without one since the start. */
typedef struct laconic_filter {
    laconic_state state;
    laconic_real bias_rad_per_s;
    laconic_filter_settings settings;
    laconic_factors covariance;
    laconic_real forcing[3][3], forcing_variance_s[3]; /* noise of b: columns, and variance times step_s      */
    int32_t dof, travels, biases, errors;              /* rows: travels, x, y, θ, biases, then dof of ζ       */
    struct {                                           /* space for a prediction                               */
        laconic_real row[LACONIC_FILTER_ERRORS][LACONIC_FILTER_ERRORS + LACONIC_FILTER_NOISES];
        laconic_real weight[LACONIC_FILTER_ERRORS + LACONIC_FILTER_NOISES];
        laconic_factors next;
    } room;
} laconic_filter;

/* A filter that begins at `state`, of which the wheel angles are not taken over. Refuses NOT_FINITE, NEGATIVE and
 * OVERFLOW (a variance leaves the range) for a number of the settings. */
laconic_status laconic_filter_start(laconic_filter *filter, const laconic_model *model,
                                    const laconic_filter_settings *settings, const laconic_state *state);

/* One step of the integrator with the input held. Refuses as laconic_step() does, and OVERFLOW where the covariance
 * leaves the range. Model and integrator may change from call to call, except for the wheels and the degrees of
 * freedom. Noise of voltages and forces stays that of the model at the start. */
laconic_status laconic_filter_predict(laconic_filter *filter, const laconic_model *model,
                                      const laconic_integrator *integrator, const laconic_input *held);

/* The same by one method (derivatives.h), which refuses METHOD_UNKNOWN for an integrator of another. */
laconic_status laconic_filter_predict_by(laconic_filter *filter, const laconic_derivation *derivation,
                                         const laconic_model *model, const laconic_integrator *integrator,
                                         const laconic_input *held);

/* --------------------------------------------------------------------------------- readings -- */

/* How far a reading was from what was expected. If the filter's numbers are right, `square` is χ²-distributed with
 * `count` degrees of freedom: above 9 + 2 · count or so doubt the reading, or the settings. */
typedef struct laconic_innovation {
    int32_t count;       /* numbers of the reading */
    laconic_real square; /* rᵀS⁻¹r                 */
} laconic_innovation;

/* A reading corrects the estimate at this moment: after predictions up to it. `innovation` may be NULL. Refuses NOT_FINITE
 * for a reading, NOT_POSITIVE where the settings have no such instrument, OVERFLOW where the estimate leaves the
 * range. */

/* Angles by which the wheels have turned since the last call; those of wheels without encoder are not read. */
laconic_status laconic_filter_encoders(laconic_filter *filter, const laconic_model *model,
                                       const laconic_real turned_rad[], laconic_innovation *innovation);

/* Takes the gyro's reading, about the upward axis. */
laconic_status laconic_filter_yaw_rate(laconic_filter *filter, const laconic_model *model,
                                       laconic_real yaw_rate_rad_per_s, laconic_innovation *innovation);

/* Takes the observed place of a point of the body and the body's heading, from a camera, a satellite receiver or a
 * scan matcher. A standard deviation of 0: that was not seen. */
typedef struct laconic_pose_fix {
    laconic_real x_m, y_m, heading_rad; /* the heading in any turn                                          */
    laconic_real std_m, heading_std_rad;
    laconic_real place_x_m, place_y_m; /* the point, in the body frame; 0, 0: the body's origin             */
} laconic_pose_fix;

/* Refuses also NEGATIVE for a standard deviation. */
laconic_status laconic_filter_fix(laconic_filter *filter, const laconic_model *model, const laconic_pose_fix *fix,
                                  laconic_innovation *innovation);

/* Angles of wheels from counts of their encoders before and now, by the shorter way round; 0 for a wheel without. */
void laconic_filter_turned(laconic_real turned_rad[], const laconic_sensor_settings *sensors, const int32_t before[],
                           const int32_t now[], int32_t wheel_count);

/* --------------------------------------------------------------------------------- outputs -- */

/* Writes the covariance of (ν1, ν2, ν3, x, y, θ, bias), 7 × 7 numbers row by row, symmetric; rows of a bias that is
 * not estimated are 0. */
#define LACONIC_FILTER_OUTPUTS 7
void laconic_filter_covariance(laconic_real matrix[], const laconic_filter *filter, const laconic_model *model);

#ifdef __cplusplus
}
#endif
#endif
