/* Start of a filter, its prediction over a step, and its covariance. The errors' transition is that of the step's own
 * derivatives by ζ and heading: nothing else enters a step, so all other columns are those of the identity. */
#include "factors.h"

/* ------------------------------------------------------------------------------------ start -- */

static laconic_status check_settings(const laconic_filter_settings *settings, int32_t wheels) {
    const real *number = (const real *)(const void *)settings;
    const int32_t before = (int32_t)(offsetof(laconic_filter_settings, encoder_std_rad) / sizeof(real));
    for (int32_t i = 0; i <= before + wheels; i++) {
        const real x = i == before + wheels ? settings->yaw_rate_std_rad_per_s : number[i];
        if (!is_finite(x)) return LACONIC_NOT_FINITE;
        if (x < R(0)) return LACONIC_NEGATIVE;
        if (!is_finite(x * x)) return LACONIC_OVERFLOW;
    }
    return LACONIC_OK;
}

/* Half the square: of a one-sided density the variance that a number held for 1 s has. */
static real held_variance_s(real density) { return R(0.5) * density * density; }

/* Adds variance · v vᵀ to the factors of a covariance of ζ. */
static void add_vector(laconic_factors *factors, vector v, real variance, int32_t dof) {
    const real component[3] = {v.x, v.y, v.z};
    real row[3][COLUMNS], weight[COLUMNS];
    for (int32_t i = 0; i < dof; i++) {
        for (int32_t j = 0; j < dof; j++) row[i][j] = factors->upper[i][j];
        row[i][dof] = component[i];
        weight[i] = factors->diagonal[i];
    }
    weight[dof] = variance;
    laconic_factors_of(factors, row, weight, dof, dof + 1);
}

/* No variance at all. */
static void set_certain(laconic_factors *factors) {
    const laconic_factors zero = ALL_ZERO;
    *factors = zero;
    for (int32_t i = 0; i < ERRORS; i++) factors->upper[i][i] = R(1);
}

/* White noise of voltages and forces as noise of b. */
static void set_forcing(laconic_filter *f, const laconic_model *m) {
    const laconic_filter_settings *s = &f->settings;
    laconic_factors b;
    set_certain(&b);
    for (int32_t i = 0; i < LACONIC_WHEELS(m); i++)
        add_vector(&b, scaled(m->voltage_scale[own(i)], vec(m->wheel_of_zeta[i])),
                   held_variance_s(s->voltage_noise_V_per_sqrt_Hz), f->dof);
    for (int k = 0; k < 2; k++)
        add_vector(&b, scaled(m->torque_scale, vec(m->velocity_of_zeta[k])),
                   held_variance_s(s->force_noise_N_per_sqrt_Hz), f->dof);
    add_vector(&b, scaled(m->torque_scale, vec(m->yaw_rate_of_zeta)), held_variance_s(s->moment_noise_Nm_per_sqrt_Hz),
               f->dof);
    for (int32_t i = 0; i < f->dof; i++) {
        for (int32_t j = 0; j < f->dof; j++) f->forcing[i][j] = b.upper[i][j];
        f->forcing_variance_s[i] = b.diagonal[i];
    }
}

static void set_covariance(laconic_filter *f, const laconic_model *m) {
    const laconic_filter_settings *s = &f->settings;
    const int32_t x = row_of_x(f), first = row_of_zeta(f);
    laconic_factors zeta, *all = &f->covariance;
    set_certain(&zeta);
    for (int k = 0; k < 3; k++) {
        real nu[3] = {R(0), R(0), R(0)};
        nu[k] = s->nu_std_rad_per_s[k];
        add_vector(&zeta, zeta_of_nu(m, nu), R(1), f->dof);
    }
    set_certain(all);
    all->diagonal[x] = all->diagonal[x + 1] = s->position_std_m * s->position_std_m;
    all->diagonal[row_of_heading(f)] = s->heading_std_rad * s->heading_std_rad;
    if (f->biases > 0) all->diagonal[row_of_bias(f)] = s->bias_std_rad_per_s * s->bias_std_rad_per_s;
    for (int32_t i = 0; i < f->dof; i++) {
        for (int32_t j = i + 1; j < f->dof; j++) all->upper[first + i][first + j] = zeta.upper[i][j];
        all->diagonal[first + i] = zeta.diagonal[i];
    }
}

static bool has_encoder(const laconic_filter_settings *settings, int32_t wheels) {
    for (int32_t i = 0; i < wheels; i++)
        if (settings->encoder_std_rad[i] > R(0)) return true;
    return false;
}

laconic_status laconic_filter_start(laconic_filter *filter, const laconic_model *model,
                                    const laconic_filter_settings *settings, const laconic_state *state) {
    laconic_filter fresh = ALL_ZERO;
    const laconic_status status = check_settings(settings, LACONIC_WHEELS(model));
    if (status != LACONIC_OK) return status;
    fresh.settings = *settings;
    fresh.state = *state;
    for (int k = 0; k < 3; k++) fresh.state.travel[k] = sum_of(R(0));
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) fresh.state.wheel_angle_set_rad[i] = R(0);
    fresh.dof = model->dof;
    fresh.travels = has_encoder(settings, LACONIC_WHEELS(model)) ? fresh.dof : 0;
    fresh.biases = settings->bias_std_rad_per_s > R(0) || settings->bias_noise_rad_per_s2_per_sqrt_Hz > R(0);
    fresh.errors = fresh.travels + 3 + fresh.biases + fresh.dof;
    set_forcing(&fresh, model);
    set_covariance(&fresh, model);
    if (!is_finite(rows_size((const real(*)[3])fresh.forcing, 3) + size(vec(fresh.forcing_variance_s))) ||
        !laconic_factors_finite(&fresh.covariance, fresh.errors))
        return LACONIC_OVERFLOW;
    *filter = fresh;
    return LACONIC_OK;
}

/* ------------------------------------------------------------------------------- transition -- */

/* How the errors after a step change with one number. */
typedef struct error_change {
    vector travel, zeta;
    real x_m, y_m, heading_rad;
} error_change;

/* By the three components of ζ, of b, and by the heading. */
#define BY_B 3
#define BY_HEADING 6
#define CHANGES 7
#define GROUPS_OF_SIX ((6 + LANES - 1) / LANES)

static error_change change_of(const laconic_state_change *after, const step_direction *in, const step_response *by,
                              int lane_of_it) {
    error_change out;
    out.zeta = plus(lane_vector(in->zeta, lane_of_it), lane_vector(by->delta, lane_of_it));
    out.travel = lane_vector(by->path, lane_of_it);
    out.x_m = after->x_m;
    out.y_m = after->y_m;
    out.heading_rad = after->heading_rad;
    return out;
}

/* A further yaw turns the displacement, and a force fixed in the world against the body. */
static step_direction heading_direction(const taken_step *s) {
    step_direction d = {no_lanes(), no_lanes(), no_lanes(), no_lanes(), NULL};
    d.cosine = lanes_of(s->at.sine);
    d.sine = lanes_of(scaled(R(-1), s->at.cosine));
    return d;
}

static void find_changes(error_change change[CHANGES], taken_step *s, const laconic_state *state) {
    const step_direction still = {no_lanes(), no_lanes(), no_lanes(), no_lanes(), NULL};
    step_direction in[GROUPS_OF_SIX + 1];
    step_response out[GROUPS_OF_SIX + 1];
    laconic_state_change after[LANES];
    for (int n = 0; n < GROUPS_OF_SIX; n++) in[n] = still;
    for (int k = 0; k < 6; k++) set_lane((lane *)(void *)&in[k / LANES] + k, k % LANES, R(1));
    in[GROUPS_OF_SIX] = heading_direction(s);
    laconic_respond(s, state, out, in, GROUPS_OF_SIX + 1);
    for (int k = 0; k < 6; k++) {
        const int n = k / LANES;
        if (k % LANES == 0) laconic_finish_step(after, LANES, s, &in[n], &out[n], R(0));
        change[k] = change_of(&after[k % LANES], &in[n], &out[n], k % LANES);
    }
    laconic_finish_step(after, 1, s, &in[GROUPS_OF_SIX], &out[GROUPS_OF_SIX], R(1));
    change[BY_HEADING] = change_of(after, &in[GROUPS_OF_SIX], &out[GROUPS_OF_SIX], 0);
}

/* Adds factor · change to a column of a matrix whose rows are the errors. */
static void add_column(real matrix[][COLUMNS], int32_t column, const laconic_filter *f, real factor,
                       const error_change *by) {
    const real travel[3] = {by->travel.x, by->travel.y, by->travel.z}, zeta[3] = {by->zeta.x, by->zeta.y, by->zeta.z};
    const int32_t x = row_of_x(f), first = row_of_zeta(f);
    for (int32_t k = 0; k < f->travels; k++) matrix[k][column] += factor * travel[k];
    matrix[x][column] += factor * by->x_m;
    matrix[x + 1][column] += factor * by->y_m;
    matrix[x + 2][column] += factor * by->heading_rad;
    for (int32_t k = 0; k < f->dof; k++) matrix[first + k][column] += factor * zeta[k];
}

/* F U: rows of the errors that stay are those of U; to all a column is added what it has of ζ and heading. */
static void set_transported(laconic_filter *f, const error_change change[CHANGES]) {
    const int32_t heading = row_of_heading(f), first = row_of_zeta(f);
    const laconic_factors *p = &f->covariance;
    for (int32_t j = 0; j < f->errors; j++) {
        for (int32_t i = 0; i < f->errors; i++) f->room.row[i][j] = i == heading || i >= first ? R(0) : p->upper[i][j];
        f->room.weight[j] = p->diagonal[j];
        if (j >= heading) add_column(f->room.row, j, f, p->upper[heading][j], &change[BY_HEADING]);
        for (int32_t k = 0; first + k <= j; k++) add_column(f->room.row, j, f, p->upper[first + k][j], &change[k]);
    }
}

/* An empty column of noise with its variance. */
static int32_t next_column(laconic_filter *f, int32_t *columns, real variance) {
    for (int32_t i = 0; i < f->errors; i++) f->room.row[i][*columns] = R(0);
    f->room.weight[*columns] = variance;
    return (*columns)++;
}

static void add_unit(laconic_filter *f, int32_t *columns, int32_t row, real variance) {
    if (variance > R(0)) f->room.row[row][next_column(f, columns, variance)] = R(1);
}

/* Returns the number of columns. */
static int32_t add_noise(laconic_filter *f, const error_change change[CHANGES], real h) {
    const laconic_filter_settings *s = &f->settings;
    const real slip = held_variance_s(s->slip_noise_m_per_s_per_sqrt_Hz) * h;
    const real yaw_slip = held_variance_s(s->yaw_slip_noise_rad_per_s_per_sqrt_Hz) * h;
    const real drift = held_variance_s(s->bias_noise_rad_per_s2_per_sqrt_Hz) * h;
    int32_t columns = f->errors;
    for (int32_t k = 0; k < f->dof; k++) {
        if (!(f->forcing_variance_s[k] > R(0))) continue;
        const int32_t column = next_column(f, &columns, f->forcing_variance_s[k] / h);
        for (int32_t i = 0; i <= k; i++) add_column(f->room.row, column, f, f->forcing[i][k], &change[BY_B + i]);
    }
    add_unit(f, &columns, row_of_x(f), slip);
    add_unit(f, &columns, row_of_x(f) + 1, slip);
    add_unit(f, &columns, row_of_heading(f), yaw_slip);
    if (f->biases > 0) add_unit(f, &columns, row_of_bias(f), drift);
    return columns;
}

laconic_status laconic_filter_predict_by(laconic_filter *filter, const laconic_derivation *derivation,
                                         const laconic_model *model, const laconic_integrator *integrator,
                                         const laconic_input *held) {
    taken_step s;
    error_change change[CHANGES];
    laconic_state after = filter->state;
    laconic_status status = laconic_take_step(&s, derivation, model, integrator, &filter->state, held, false);
    if (status == LACONIC_OK) status = laconic_step(model, integrator, &after, held);
    if (status != LACONIC_OK) return status;
    find_changes(change, &s, &filter->state);
    set_transported(filter, change);
    const int32_t columns = add_noise(filter, change, integrator->step_s);
    laconic_factors_of(&filter->room.next, filter->room.row, filter->room.weight, filter->errors, columns);
    if (!laconic_factors_finite(&filter->room.next, filter->errors)) return LACONIC_OVERFLOW;
    filter->covariance = filter->room.next;
    filter->state = after;
    return LACONIC_OK;
}

laconic_status laconic_filter_predict(laconic_filter *filter, const laconic_model *model,
                                      const laconic_integrator *integrator, const laconic_input *held) {
    return laconic_filter_predict_by(filter, &laconic_derivation_of_all, model, integrator, held);
}

/* ------------------------------------------------------------------------------- covariance -- */

/* Row `output` of the outputs' errors by the filter's, times U. */
static void output_row(real row[ERRORS], int32_t output, const laconic_filter *f, const laconic_model *m) {
    const laconic_factors *p = &f->covariance;
    for (int32_t j = 0; j < f->errors; j++) {
        row[j] = R(0);
        if (output >= 3 && output < 6 + f->biases) row[j] = p->upper[row_of_x(f) + output - 3][j];
        if (output >= 3) continue;
        for (int32_t k = 0; k < f->dof; k++) row[j] += m->nu_of_zeta[output][k] * p->upper[row_of_zeta(f) + k][j];
    }
}

void laconic_filter_covariance(laconic_real matrix[], const laconic_filter *filter, const laconic_model *model) {
    real row[LACONIC_FILTER_OUTPUTS][ERRORS];
    for (int32_t i = 0; i < LACONIC_FILTER_OUTPUTS; i++) {
        output_row(row[i], i, filter, model);
        for (int32_t j = 0; j <= i; j++) {
            real sum = R(0);
            for (int32_t k = 0; k < filter->errors; k++) sum += row[i][k] * filter->covariance.diagonal[k] * row[j][k];
            matrix[i * LACONIC_FILTER_OUTPUTS + j] = matrix[j * LACONIC_FILTER_OUTPUTS + i] = sum;
        }
    }
}
