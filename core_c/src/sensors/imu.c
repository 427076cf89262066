/* The inertial measurement unit: what a place of the body feels, and what the instrument makes of it. docs/sensors.md
 * has the formulae. */
#include "imu.h"

#include "step_internals.h"

#define STREAM_OF_ACCELERATION 0U
#define STREAM_OF_YAW_RATE 1U

/* -------------------------------------------------------------------- motion of a place of the body -- */

/* Motion of S in body axes, with its derivative. */
typedef struct place_motion {
    real velocity[2], yaw_rate; /* v_S, ω */
    real change[2], yaw_change; /* of these components, v' and ω' */
} place_motion;

static place_motion motion_of(const laconic_model *model, const real nu[3], const real rate[3]) {
    const real radius = model->wheel_radius_m;
    const place_motion moved = {{radius * nu[0], radius * nu[1]},
                                nu[2] / model->yaw_scale,
                                {radius * rate[0], radius * rate[1]},
                                rate[2] / model->yaw_scale};
    return moved;
}

/* a_P = v' + ω × v + ω' × d − ω² d, with d from S to P. */
static void accelerate(real out[2], const place_motion *m, real dx, real dy) {
    const real square = m->yaw_rate * m->yaw_rate;
    out[0] = (m->change[0] - m->yaw_rate * m->velocity[1]) - (m->yaw_change * dy + square * dx);
    out[1] = (m->change[1] + m->yaw_rate * m->velocity[0]) + (m->yaw_change * dx - square * dy);
}

void laconic_acceleration_of_rates(laconic_real acceleration_m_per_s2[2], const laconic_model *model,
                                   const laconic_real nu_rad_per_s[3], const laconic_real nu_rad_per_s2[3]) {
    const place_motion m = motion_of(model, nu_rad_per_s, nu_rad_per_s2);
    accelerate(acceleration_m_per_s2, &m, -model->com_x_m, -model->com_y_m);
}

/* The derivative of the above, which is linear in ν' and quadratic in ν. */
void laconic_acceleration_tangent(laconic_real change[2], const laconic_model *model,
                                  const laconic_real nu_rad_per_s[3], const laconic_real by_nu_rad_per_s[3],
                                  const laconic_real by_nu_rad_per_s2[3]) {
    const vector zeta = zeta_of_nu(model, nu_rad_per_s), d_zeta = zeta_of_nu(model, by_nu_rad_per_s);
    const real dx = -model->com_x_m, dy = -model->com_y_m;
    real nu[3], d_nu[3];
    for (int k = 0; k < 3; k++) {
        nu[k] = dot(vec(model->nu_of_zeta[k]), zeta);
        d_nu[k] = dot(vec(model->nu_of_zeta[k]), d_zeta);
    }
    const place_motion m = motion_of(model, nu, by_nu_rad_per_s2), d = motion_of(model, d_nu, by_nu_rad_per_s2);
    const real square = R(2) * m.yaw_rate * d.yaw_rate;
    change[0] =
        d.change[0] - (m.yaw_rate * d.velocity[1] + d.yaw_rate * m.velocity[1]) - (d.yaw_change * dy + square * dx);
    change[1] =
        d.change[1] + (m.yaw_rate * d.velocity[0] + d.yaw_rate * m.velocity[0]) + (d.yaw_change * dx - square * dy);
}

/* ------------------------------------------------------------------------------ what an IMU feels -- */

/* An accelerometer feels what holds it, not gravity: on a slope that is the acceleration less gravity's part along the
 * ground, so at rest it shows g sin α uphill. */
static void feel(laconic_imu_sample *sample, const laconic_imu_settings *imu, const laconic_model *model,
                 const real acceleration[2], real yaw_rate, direction heading) {
    const wrench pull = slope_seen(model, heading);
    const real along = acceleration[0] - pull.along / model->mass_kg;
    const real across = acceleration[1] - pull.across / model->mass_kg;
    const direction axes = laconic_direction_of_angle(imu->heading_rad);
    sample->specific_force_m_per_s2[0] = axes.cosine * along + axes.sine * across;
    sample->specific_force_m_per_s2[1] = axes.cosine * across - axes.sine * along;
    sample->yaw_rate_rad_per_s = yaw_rate;
}

static void feel_motion(laconic_imu_sample *sample, const laconic_imu_settings *imu, const laconic_model *model,
                        const place_motion *m, direction heading) {
    real acceleration[2];
    accelerate(acceleration, m, imu->x_m - model->com_x_m, imu->y_m - model->com_y_m);
    feel(sample, imu, model, acceleration, m->yaw_rate, heading);
}

void laconic_imu_feel(laconic_imu_sample *sample, const laconic_imu_settings *imu, const laconic_model *model,
                      const laconic_real nu_rad_per_s[3], const laconic_real nu_rad_per_s2[3],
                      laconic_real heading_rad) {
    const place_motion m = motion_of(model, nu_rad_per_s, nu_rad_per_s2);
    feel_motion(sample, imu, model, &m, laconic_direction_of_angle(heading_rad));
}

/* ------------------------------------------------------------------------------- of a plant's state -- */

/* On ideal ground: (4.7) at this moment. */
static place_motion motion_now(const laconic_plant *plant, const laconic_input *input, direction heading) {
    const laconic_model *model = &plant->model;
    const vector zeta = zeta_of(&plant->state);
    real nu[3], rate[3];
    laconic_forcing forcing;
    laconic_forcing_of(&forcing, model, input);
    const vector change =
        zeta_rate(model, zeta, forcing.rotates ? forcing_at(&forcing, heading) : vec(forcing.constant));
    for (int k = 0; k < 3; k++) {
        nu[k] = dot(vec(model->nu_of_zeta[k]), zeta);
        rate[k] = dot(vec(model->nu_of_zeta[k]), change);
    }
    return motion_of(model, nu, rate);
}

static direction heading_of(const laconic_plant *plant) {
    return laconic_direction_of_binary_angle(plant->state.heading.fraction);
}

void laconic_imu_feel_now(laconic_imu_sample *sample, const laconic_imu_settings *imu, const laconic_plant *plant,
                          const laconic_input *input) {
    const direction heading = heading_of(plant);
    const place_motion m = motion_now(plant, input, heading);
    feel_motion(sample, imu, &plant->model, &m, heading);
}

void laconic_accelerate_now(laconic_real acceleration_m_per_s2[2], const laconic_plant *plant,
                            const laconic_input *input) {
    const place_motion m = motion_now(plant, input, heading_of(plant));
    accelerate(acceleration_m_per_s2, &m, -plant->model.com_x_m, -plant->model.com_y_m);
}

/* ------------------------------------------------------------------------------- mean over a step -- */

/* In world axes the mean acceleration is (v⁺ − v)/h; in those of the step's middle v⁺ is turned by half the yaw of the
 * step forwards, v by half backwards. Returns that half as a direction. */
static direction mean_acceleration(real out[2], const laconic_plant *plant, const laconic_sensor_moment *before,
                                   real dx, real dy) {
    const real h = plant->integrator.step_s;
    real v[2];
    const real yaw_rate = laconic_body_velocity(&plant->model, &plant->state, v), old = before->yaw_rate_rad_per_s;
    const direction half = laconic_direction_of_angle(R(0.25) * h * (old + yaw_rate));
    const real end[2] = {v[0] - yaw_rate * dy, v[1] + yaw_rate * dx};
    const real start[2] = {before->velocity_m_per_s[0] - old * dy, before->velocity_m_per_s[1] + old * dx};
    out[0] = (half.cosine * (end[0] - start[0]) - half.sine * (end[1] + start[1])) / h;
    out[1] = (half.cosine * (end[1] - start[1]) + half.sine * (end[0] + start[0])) / h;
    return half;
}

void laconic_imu_feel_step(laconic_imu_sample *sample, const laconic_imu_settings *imu, const laconic_plant *plant,
                           const laconic_sensor_moment *before) {
    const laconic_model *model = &plant->model;
    const direction now = heading_of(plant);
    real acceleration[2], v[2];
    const direction half =
        mean_acceleration(acceleration, plant, before, imu->x_m - model->com_x_m, imu->y_m - model->com_y_m);
    const direction middle = {now.cosine * half.cosine + now.sine * half.sine,
                              now.sine * half.cosine - now.cosine * half.sine};
    feel(sample, imu, model, acceleration, laconic_body_velocity(model, &plant->state, v), middle);
}

void laconic_accelerate_over_step(laconic_real acceleration_m_per_s2[2], const laconic_plant *plant,
                                  const laconic_sensor_moment *before) {
    (void)mean_acceleration(acceleration_m_per_s2, plant, before, -plant->model.com_x_m, -plant->model.com_y_m);
}

/* ------------------------------------------------------------------------------ what an IMU shows -- */

typedef struct channel { /* errors of one axis */
    real scale_error, bias, deviation, range;
} channel;

static real shown(const channel *c, real truth, real normal) {
    const real value = truth + (c->scale_error * truth + c->bias) + c->deviation * normal;
    return c->range > R(0) ? cut(value, c->range) : value;
}

/* Half the sample rate is the band of the noise, whose density is one-sided. */
static real deviation_of(real density, real step_s) {
    return density > R(0) ? density * laconic_root(R(0.5) / step_s) : R(0);
}

static void draw(real pair[2], const laconic_imu_settings *imu, real deviation, uint32_t stream, uint64_t number) {
    pair[0] = pair[1] = R(0);
    if (deviation > R(0)) laconic_normal_pair(pair, (uint32_t)imu->seed, stream, number);
}

void laconic_imu_show(const laconic_imu_settings *imu, const laconic_imu_sample *sample, uint64_t number,
                      laconic_real step_s, laconic_real acceleration_m_per_s2[2], laconic_real *yaw_rate_rad_per_s) {
    const real deviation = deviation_of(imu->acceleration_noise_m_per_s2_per_sqrt_Hz, step_s);
    const channel gyro = {imu->yaw_rate_scale_error, imu->yaw_rate_bias_rad_per_s,
                          deviation_of(imu->yaw_rate_noise_rad_per_s_per_sqrt_Hz, step_s),
                          imu->yaw_rate_range_rad_per_s};
    real normal[2];
    draw(normal, imu, deviation, STREAM_OF_ACCELERATION, number);
    for (int k = 0; k < 2; k++) {
        const channel axis = {imu->acceleration_scale_error[k], imu->acceleration_bias_m_per_s2[k], deviation,
                              imu->acceleration_range_m_per_s2};
        acceleration_m_per_s2[k] = shown(&axis, sample->specific_force_m_per_s2[k], normal[k]);
    }
    draw(normal, imu, gyro.deviation, STREAM_OF_YAW_RATE, number);
    *yaw_rate_rad_per_s = shown(&gyro, sample->yaw_rate_rad_per_s, normal[0]);
}
