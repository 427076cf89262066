/* Solves mass · x = push + Cᵀκ with C x = target. mass = L diag(1/d) Lᵀ without roots; the rows z = L⁻¹Cᵀ are made
 * orthogonal in the metric d one after another (twice, for rounding), and each moves y = L⁻¹ push along itself until
 * its target holds. So a row that depends on earlier ones is found by what is left of it, relative to itself. */
#include "articulated_equations.h"

#if LACONIC_MAX_BODIES > 0

/* An own hinge turns without inertia where its pivot is rounding beside its diagonal entry. */
#define SMALLEST_PIVOT (R(64) * LACONIC_EPSILON)

/* A row that depends on others asks for the same motion as they do, but for rounding of targets. */
#define SAME_MOTION (R(1000) * LACONIC_RANK_TOLERANCE)

typedef struct factored {
    int32_t n;
    real lower[LACONIC_MAX_VELOCITIES][LACONIC_MAX_VELOCITIES];
    real inverse_pivot[LACONIC_MAX_VELOCITIES]; /* d */
} factored;

/* Returns the velocity without inertia, −1: there is none. */
static int32_t factor(factored *f, const articulated_sweep *s, int32_t n) {
    f->n = n;
    for (int32_t i = 0; i < n; i++) {
        real scaled_row[LACONIC_MAX_VELOCITIES], pivot = s->mass[i][i];
        for (int32_t j = 0; j < i; j++) {
            real v = s->mass[i][j];
            for (int32_t l = 0; l < j; l++) v -= scaled_row[l] * f->lower[j][l];
            scaled_row[j] = v;
            f->lower[i][j] = v * f->inverse_pivot[j];
            pivot -= v * f->lower[i][j];
        }
        if (!(pivot > SMALLEST_PIVOT * s->mass[i][i])) return i;
        f->inverse_pivot[i] = R(1) / pivot;
    }
    return -1;
}

/* y = L⁻¹ v */
static void forward(real *y, const factored *f, const real *v) {
    for (int32_t i = 0; i < f->n; i++) {
        real sum = v[i];
        for (int32_t l = 0; l < i; l++) sum -= f->lower[i][l] * y[l];
        y[i] = sum;
    }
}

/* x = L⁻ᵀ d y */
static void backward(real *x, const factored *f, const real *y) {
    for (int32_t i = f->n - 1; i >= 0; i--) {
        real sum = f->inverse_pivot[i] * y[i];
        for (int32_t l = i + 1; l < f->n; l++) sum -= f->lower[l][i] * x[l];
        x[i] = sum;
    }
}

static real product(const factored *f, const real *a, const real *b) {
    real sum = R(0);
    for (int32_t i = 0; i < f->n; i++) sum += f->inverse_pivot[i] * a[i] * b[i];
    return sum;
}

static void add_multiple(const factored *f, real *y, real by, const real *z) {
    for (int32_t i = 0; i < f->n; i++) y[i] += by * z[i];
}

/* Rows that count, orthonormal in the metric d; row r of C is Σ triangle[q] unit[q]. */
typedef struct kept_rows {
    int32_t count;
    int32_t row[LACONIC_MAX_VELOCITIES];
    real unit[LACONIC_MAX_VELOCITIES][LACONIC_MAX_VELOCITIES];
    real triangle[LACONIC_MAX_VELOCITIES][LACONIC_MAX_VELOCITIES];
    real along[LACONIC_MAX_VELOCITIES]; /* what the rows push along their units */
} kept_rows;

/* Adds row r where it asks for something new, and moves y so that it holds. Returns false where it depends on earlier
 * ones but contradicts them. */
static bool keep_row(kept_rows *k, const factored *f, real *y, const real *row, real target, int32_t r) {
    real z[LACONIC_MAX_VELOCITIES], part[LACONIC_MAX_VELOCITIES] = {R(0)};
    forward(z, f, row);
    const real whole = product(f, z, z), have = product(f, z, y);
    for (int pass = 0; pass < 2; pass++)
        for (int32_t q = 0; q < k->count; q++) {
            const real along = product(f, z, k->unit[q]);
            part[q] += along;
            add_multiple(f, z, -along, k->unit[q]);
        }
    const real left = product(f, z, z);
    if (k->count == f->n || !(left > LACONIC_RANK_TOLERANCE * LACONIC_RANK_TOLERANCE * whole)) {
        const real size = magnitude(target) + magnitude(have) + laconic_root(whole * product(f, y, y));
        return magnitude(target - have) <= SAME_MOTION * size + LACONIC_REAL_MIN;
    }
    const real length = laconic_root(left), inverse = R(1) / length;
    const int32_t q = k->count++;
    k->row[q] = r;
    for (int32_t i = 0; i < f->n; i++) k->unit[q][i] = inverse * z[i];
    for (int32_t i = 0; i < q; i++) k->triangle[q][i] = part[i];
    k->triangle[q][q] = length;
    k->along[q] = (target - have) * inverse;
    add_multiple(f, y, k->along[q], k->unit[q]);
    return true;
}

/* κ of the kept rows from Σ κ_r row_r = Σ along_q unit_q; 0 of the others. */
static void multipliers(real *multiplier, const kept_rows *k, int32_t row_count) {
    for (int32_t r = 0; r < row_count; r++) multiplier[r] = R(0);
    for (int32_t q = k->count - 1; q >= 0; q--) {
        real sum = k->along[q];
        for (int32_t p = q + 1; p < k->count; p++) sum -= k->triangle[p][q] * multiplier[k->row[p]];
        multiplier[k->row[q]] = sum / k->triangle[q][q];
    }
}

/* `row` is one row too many; another wheel that disagrees with it is that of the row kept last. */
static laconic_status refuse_rows(const laconic_articulated_model *m, const kept_rows *k, int32_t row,
                                  laconic_refusal *why) {
    int32_t other = 0;
    for (int32_t q = 0; q < k->count; q++)
        if (m->row[k->row[q]].wheel != m->row[row].wheel) other = m->row[k->row[q]].wheel + 1;
    return refuse(why, LACONIC_WHEELS_DISAGREE, LACONIC_FIELD_AXLE, m->row[row].wheel + 1, (real)other, R(0));
}

/* The mass of ζ is at least 1: its pivots are lost only where bodies are too far apart in mass. */
static laconic_status refuse_massless(const laconic_articulated_model *m, int32_t velocity, laconic_refusal *why) {
    int32_t massless = 0;
    if (velocity < m->carriage_dof)
        return refuse(why, LACONIC_ILL_CONDITIONED, LACONIC_FIELD_NONE, 0, R(1) / SMALLEST_PIVOT, R(0));
    for (int32_t b = 1; b <= m->body_count; b++)
        if (m->link[b - 1].motion == LACONIC_MOTION_OWN && m->carriage_dof + m->link[b - 1].column == velocity)
            massless = b;
    return refuse(why, LACONIC_MASSLESS_HINGE, (laconic_field)LACONIC_FIELD_OF_BODY_YAW_INERTIA, massless, R(0), R(0));
}

/* Factors the mass, keeps the rows that count and moves y onto them. */
static laconic_status factor_and_keep(factored *f, kept_rows *k, real *y, const articulated_sweep *s,
                                      const laconic_articulated_model *m, const real *target, laconic_refusal *why) {
    const int32_t massless = factor(f, s, m->dof);
    if (massless >= 0) return refuse_massless(m, massless, why);
    k->count = 0;
    forward(y, f, s->push);
    for (int32_t r = 0; r < m->row_count; r++)
        if (!keep_row(k, f, y, s->left[r], target[r], r) || k->count == m->dof) return refuse_rows(m, k, r, why);
    return LACONIC_OK;
}

laconic_status laconic_articulated_keep_rows(int32_t kept[], int32_t *count, const articulated_sweep *s,
                                             const laconic_articulated_model *m, const real *target,
                                             laconic_refusal *why) {
    factored f;
    kept_rows k;
    real y[LACONIC_MAX_VELOCITIES];
    const laconic_status status = factor_and_keep(&f, &k, y, s, m, target, why);
    *count = k.count;
    for (int32_t q = 0; status == LACONIC_OK && q < k.count; q++) kept[q] = k.row[q];
    return status;
}

laconic_status laconic_articulated_solve_rates(real *eta_rate, real *correction, const articulated_sweep *s,
                                               const laconic_articulated_model *m, laconic_refusal *why) {
    factored f;
    kept_rows k;
    real y[LACONIC_MAX_VELOCITIES], target[LACONIC_MAX_LEFT_ROWS];
    for (int32_t r = 0; r < m->row_count; r++) target[r] = -s->row_bias[r];
    laconic_status status = factor_and_keep(&f, &k, y, s, m, target, why);
    if (status != LACONIC_OK) return status;
    backward(eta_rate, &f, y);
    if (correction == NULL) return LACONIC_OK;
    for (int32_t i = 0; i < m->dof; i++) y[i] = R(0);
    for (int32_t q = 0; q < k.count; q++) {
        real along = -s->row_value[k.row[q]];
        for (int32_t p = 0; p < q; p++) along -= k.triangle[q][p] * k.along[p];
        k.along[q] = along / k.triangle[q][q];
        add_multiple(&f, y, k.along[q], k.unit[q]);
    }
    backward(correction, &f, y);
    return LACONIC_OK;
}

laconic_status laconic_articulated_solve(real *x, real *multiplier, const articulated_sweep *s,
                                         const laconic_articulated_model *m, const real *target, laconic_refusal *why) {
    factored f;
    kept_rows k;
    real y[LACONIC_MAX_VELOCITIES];
    const laconic_status status = factor_and_keep(&f, &k, y, s, m, target, why);
    if (status != LACONIC_OK) return status;
    backward(x, &f, y);
    if (multiplier != NULL) multipliers(multiplier, &k, m->row_count);
    return LACONIC_OK;
}

#endif
