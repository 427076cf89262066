/* Readings of a filter: encoders, gyro, fixes of the pose. Numbers of one reading are taken one after the other, which
 * gives what all at once would, since their errors are independent; the estimate moves at the end. */
#include "factors.h"
#include "heading.h"

/* A reading that is being taken: what the estimate is to be corrected by, so far. */
typedef struct correction {
    laconic_factors factors;
    real error[ERRORS];
    laconic_innovation innovation;
} correction;

static void begin(correction *c, const laconic_filter *f) {
    c->factors = f->covariance;
    for (int32_t i = 0; i < ERRORS; i++) c->error[i] = R(0);
    c->innovation.count = 0;
    c->innovation.square = R(0);
}

/* One number, h·errors + noise, which differs from the estimate by `residual`. */
static void take(correction *c, const real h[], real residual, real std, int32_t rows) {
    real gain[ERRORS];
    for (int32_t i = 0; i < rows; i++) residual -= h[i] * c->error[i];
    const real variance = laconic_factors_update(&c->factors, gain, h, std * std, rows);
    for (int32_t i = 0; i < rows; i++) c->error[i] += gain[i] * residual;
    c->innovation.count++;
    c->innovation.square += residual * residual / variance;
}

static bool is_sound(const correction *c, const laconic_filter *f) {
    real zero = zero_if_finite(c->innovation.square), speed[3];
    store(speed, zeta_of(&f->state));
    for (int32_t i = 0; i < f->errors; i++) zero += zero_if_finite(c->error[i]);
    for (int32_t k = 0; k < f->dof; k++) speed[k] += c->error[row_of_zeta(f) + k];
    return zero == R(0) && square(vec(speed)) <= LARGEST_SPEED * LARGEST_SPEED && heading_has_room(&f->state.heading) &&
           magnitude(c->error[row_of_heading(f)]) < LARGEST_YAW_CHANGE_RAD &&
           laconic_factors_finite(&c->factors, f->errors);
}

static laconic_status finish(laconic_filter *f, const correction *c, laconic_innovation *innovation) {
    if (!is_sound(c, f)) return LACONIC_OVERFLOW;
    const real *error = c->error;
    laconic_state *state = &f->state;
    for (int32_t k = 0; k < f->travels; k++) sum_add(&state->travel[k], error[k]);
    sum_add(&state->x_m, error[row_of_x(f)]);
    sum_add(&state->y_m, error[row_of_x(f) + 1]);
    heading_advance(&state->heading, error[row_of_heading(f)]);
    if (f->biases > 0) f->bias_rad_per_s += error[row_of_bias(f)];
    for (int32_t k = 0; k < f->dof; k++) sum_add(&state->zeta[k], error[row_of_zeta(f) + k]);
    f->covariance = c->factors;
    if (innovation != NULL) *innovation = c->innovation;
    return LACONIC_OK;
}

/* --------------------------------------------------------------------------------- encoders -- */

/* After a reading the angles are measured from it. */
static void measure_from(laconic_filter *f, const laconic_model *m, const real turned_rad[]) {
    real angle[LACONIC_MAX_WHEELS];
    laconic_wheel_angles(m, &f->state, angle);
    for (int32_t i = 0; i < LACONIC_WHEELS(m); i++)
        if (f->settings.encoder_std_rad[i] > R(0)) angle[i] -= turned_rad[i];
    laconic_wheel_angles_set(m, &f->state, angle);
}

laconic_status laconic_filter_encoders(laconic_filter *filter, const laconic_model *model,
                                       const laconic_real turned_rad[], laconic_innovation *innovation) {
    correction c;
    real angle[LACONIC_MAX_WHEELS], h[ERRORS] = {R(0)};
    if (filter->travels == 0) return LACONIC_NOT_POSITIVE;
    begin(&c, filter);
    laconic_wheel_angles(model, &filter->state, angle);
    for (int32_t i = 0; i < LACONIC_WHEELS(model); i++) {
        const real std = filter->settings.encoder_std_rad[i];
        if (!(std > R(0))) continue;
        if (!is_finite(turned_rad[i])) return LACONIC_NOT_FINITE;
        for (int32_t k = 0; k < filter->travels; k++) h[k] = model->wheel_of_zeta[i][k];
        take(&c, h, turned_rad[i] - angle[i], std, filter->errors);
    }
    const laconic_status status = finish(filter, &c, innovation);
    if (status == LACONIC_OK) measure_from(filter, model, turned_rad);
    return status;
}

/* Differences of counts wrap, as the counts themselves do. */
static real counts_between(int32_t before, int32_t now, int32_t wrap) {
    if (wrap <= 0) return (real)(int32_t)((uint32_t)now - (uint32_t)before);
    int64_t counts = (int64_t)now - before;
    if (2 * counts > wrap) counts -= wrap;
    if (2 * counts < -(int64_t)wrap) counts += wrap;
    return (real)counts;
}

void laconic_filter_turned(laconic_real turned_rad[], const laconic_sensor_settings *sensors, const int32_t before[],
                           const int32_t now[], int32_t wheel_count) {
    for (int32_t i = 0; i < wheel_count; i++) {
        const laconic_encoder_settings *e = &sensors->encoder[i];
        const real gear = e->gear_ratio == R(0) ? R(1) : e->gear_ratio;
        turned_rad[i] = R(0);
        if (e->counts_per_turn > 0)
            turned_rad[i] = counts_between(before[i], now[i], sensors->encoder_wrap) *
                            (R(6.28318530717958647693) / ((real)e->counts_per_turn * gear));
    }
}

/* ------------------------------------------------------------------------------------- gyro -- */

laconic_status laconic_filter_yaw_rate(laconic_filter *filter, const laconic_model *model,
                                       laconic_real yaw_rate_rad_per_s, laconic_innovation *innovation) {
    correction c;
    real h[ERRORS] = {R(0)};
    const vector zeta = zeta_of(&filter->state);
    if (!(filter->settings.yaw_rate_std_rad_per_s > R(0))) return LACONIC_NOT_POSITIVE;
    if (!is_finite(yaw_rate_rad_per_s)) return LACONIC_NOT_FINITE;
    begin(&c, filter);
    for (int32_t k = 0; k < filter->dof; k++) h[row_of_zeta(filter) + k] = model->yaw_rate_of_zeta[k];
    if (filter->biases > 0) h[row_of_bias(filter)] = R(1);
    take(&c, h, yaw_rate_rad_per_s - dot(vec(model->yaw_rate_of_zeta), zeta) - filter->bias_rad_per_s,
         filter->settings.yaw_rate_std_rad_per_s, filter->errors);
    return finish(filter, &c, innovation);
}

/* --------------------------------------------------------------------------------- the pose -- */

static laconic_status check_fix(const laconic_pose_fix *fix) {
    const real *number = (const real *)(const void *)fix;
    for (int i = 0; i < 7; i++)
        if (!is_finite(number[i])) return LACONIC_NOT_FINITE;
    if (fix->std_m < R(0) || fix->heading_std_rad < R(0)) return LACONIC_NEGATIVE;
    return fix->std_m > R(0) || fix->heading_std_rad > R(0) ? LACONIC_OK : LACONIC_NOT_POSITIVE;
}

/* The place is at S + (ahead, aside), in world axes: a yaw moves it by (−aside, ahead). */
static void take_place(correction *c, const laconic_filter *f, const laconic_model *m, const laconic_pose_fix *fix) {
    const direction heading = laconic_direction_of_binary_angle(f->state.heading.fraction);
    const real along = fix->place_x_m - m->com_x_m, across = fix->place_y_m - m->com_y_m;
    const real ahead = heading.cosine * along - heading.sine * across;
    const real aside = heading.sine * along + heading.cosine * across;
    const int32_t x = row_of_x(f), yaw = row_of_heading(f);
    real by_x[ERRORS] = {R(0)}, by_y[ERRORS] = {R(0)};
    by_x[x] = by_y[x + 1] = R(1);
    by_x[yaw] = -aside;
    by_y[yaw] = ahead;
    take(c, by_x, fix->x_m - f->state.x_m.value - f->state.x_m.rest - ahead, fix->std_m, f->errors);
    take(c, by_y, fix->y_m - f->state.y_m.value - f->state.y_m.rest - aside, fix->std_m, f->errors);
}

static void take_heading(correction *c, const laconic_filter *f, const laconic_pose_fix *fix) {
    const laconic_binary_angle seen = laconic_binary_angle_of(fix->heading_rad);
    const signed_binary_angle beyond = (signed_binary_angle)(seen - f->state.heading.fraction);
    real h[ERRORS] = {R(0)};
    h[row_of_heading(f)] = R(1);
    take(c, h, (real)beyond * BINARY_ANGLE_UNIT_RAD, fix->heading_std_rad, f->errors);
}

laconic_status laconic_filter_fix(laconic_filter *filter, const laconic_model *model, const laconic_pose_fix *fix,
                                  laconic_innovation *innovation) {
    correction c;
    const laconic_status status = check_fix(fix);
    if (status != LACONIC_OK) return status;
    begin(&c, filter);
    if (fix->std_m > R(0)) take_place(&c, filter, model, fix);
    if (fix->heading_std_rad > R(0)) take_heading(&c, filter, fix);
    return finish(filter, &c, innovation);
}
