/* Exponential Kahan: one 3×3 solve, exact for damping and constant forcing alone, keeps every steady state. Second
 * order, and extrapolated to fourth order, which is accurate with slow and with fast damping. */
#include "step_internals.h"

typedef struct kahan_matrix {
    vector row0, row1, row2;
} kahan_matrix;

/* Cramer's rule: M⁻¹ rhs = (rhs_x c₀ + rhs_y c₁ + rhs_z c₂)/det. Where det M is almost 0, the increment is not finite
 * or so long that the step would gain energy, and the check of the energy refuses it. Of 8 million steps at h|ν| up to
 * 1000 in single precision that check refused 1.1 million; a test of det M against rounding refused one step
 * besides. */
typedef struct kahan_solver {
    vector c0, c1, c2;
    real inverse_determinant;
} kahan_solver;

/* Cofactors and determinant of M. */
INLINE kahan_solver factorise(const kahan_matrix *m) {
    kahan_solver s;
    s.c0 = cross(m->row1, m->row2);
    s.c1 = cross(m->row2, m->row0);
    s.c2 = cross(m->row0, m->row1);
    s.inverse_determinant = R(1) / dot(m->row0, s.c0);
    return s;
}

INLINE vector solve(const kahan_solver *s, vector rhs) {
    return scaled(s->inverse_determinant, plus(plus(scaled(rhs.x, s->c0), scaled(rhs.y, s->c1)), scaled(rhs.z, s->c2)));
}

/* D⁻¹ − Q with D = hφ1, Q Δ = q(ζ,Δ) = ½[(g·ζ) Δ×w + (g·Δ) ζ×w]. */
INLINE kahan_matrix implicit_matrix(vector inverse_gain, vector g, vector w, real yaw, vector zeta_cross_w) {
    const vector s = scaled(R(0.5) * yaw, w), l = scaled(R(0.5), zeta_cross_w);
    const kahan_matrix m = {
        {inverse_gain.x - l.x * g.x, -(l.x * g.y + s.z), s.y - l.x * g.z},
        {s.z - l.y * g.x, inverse_gain.y - l.y * g.y, -(l.y * g.z + s.x)},
        {-(l.z * g.x + s.y), s.x - l.z * g.y, inverse_gain.z - l.z * g.z},
    };
    return m;
}

/* Where damping is fast beside the step, ζ⁺ depends on q at the end of the step rather than on its mean q(ζ,ζ⁺). So q
 * is taken to vary linearly from q(ζ,ζ) to q(ζ⁺,ζ⁺): besides the mean that is equivalent to the constant (mean −
 * ½)·(their difference), with `mean` of laconic_decay, and for mean and slope of ζ it is a further change of b. Without
 * it ζ of a stiff vehicle lags by half the change of q over the step, divided by r, which is of first order in h; with
 * it the lag is of second order. */
INLINE vector follow_inlined(parabola *b, const laconic_model *m, const laconic_decay *d, const kahan_solver *s,
                             vector zeta, vector delta) {
    const vector g = vec(m->nu_of_zeta[2]), w = vec(m->gyro), end = plus(zeta, delta);
    const vector change = minus(scaled(dot(g, end), cross(end, w)), scaled(dot(g, zeta), cross(zeta, w)));
    const vector half = {R(0.5), R(0.5), R(0.5)};
    b->change = plus(b->change, change);
    b->varies = true;
    return plus(delta, solve(s, times(minus(vec(d->mean), half), change)));
}

typedef vector (*follower)(parabola *b, const laconic_model *m, const laconic_decay *d, const kahan_solver *s,
                           vector zeta, vector delta);

static vector follow(parabola *b, const laconic_model *m, const laconic_decay *d, const kahan_solver *s, vector zeta,
                     vector delta) {
    return follow_inlined(b, m, d, s, zeta, delta);
}

/* ζ⁺ = e^{−hr}ζ + hφ1(−hr)[q(ζ,ζ⁺) + b] on each axis, written for Δ = ζ⁺ − ζ: (D⁻¹ − Q)Δ = ζ'(ζ). */
INLINE increment kahan_increment(const laconic_model *m, const laconic_integrator *integrator, int level, vector zeta,
                                 const parabola *b, follower following) {
    const laconic_decay *d = &integrator->decay[level];
    const vector g = vec(m->nu_of_zeta[2]), w = vec(m->gyro), inverse_gain = vec(d->inverse_gain);
    const real yaw = dot(g, zeta);
    const vector zeta_cross_w = cross(zeta, w);
    const vector rate = plus(minus(scaled(yaw, zeta_cross_w), damping(m, zeta)), equivalent_constant(b, d));
    const kahan_matrix implicit = implicit_matrix(inverse_gain, g, w, yaw, zeta_cross_w);
    const kahan_solver s = factorise(&implicit);
    const vector delta = solve(&s, rate);
    increment by;
    if (integrator->stiff) {
        parabola followed = *b;
        const vector longer = following(&followed, m, d, &s, zeta, delta);
        by = increment_of(d, zeta, longer, &followed);
    } else {
        by = increment_of(d, zeta, delta, b);
    }
    return by;
}

/* For methods with several base steps. */
INLINE increment kahan_base(const laconic_model *m, const laconic_integrator *integrator, int level, vector zeta,
                            const parabola *b) {
    return kahan_increment(m, integrator, level, zeta, b, follow);
}

/* Smaller where a program has a single base step: the second-order method where b never varies. */
INLINE increment only_kahan_base(const laconic_model *m, const laconic_integrator *integrator, int level, vector zeta,
                                 const parabola *b) { /* cannot be reached: of a core without samples */
    return kahan_increment(m, integrator, level, zeta, b, follow_inlined);
}

/* ------------------------------------------------------------------------- second order -- */

RARE increment kahan_varying(const laconic_model *model, const laconic_integrator *integrator,
                             const laconic_state *state, const laconic_forcing_samples *samples) {
    return base_alone_varying(kahan_base, model, integrator, state, samples);
}

static laconic_status exponential_kahan_step(const laconic_model *model, const laconic_integrator *integrator,
                                             laconic_state *state, const laconic_forcing_samples *samples) {
    const vector zeta = zeta_of(state);
    const increment by = constant_over(samples) ? base_alone(ONLY_CONSTANT ? only_kahan_base : kahan_base, model,
                                                             integrator, zeta, samples)
                                                : kahan_varying(model, integrator, state, samples);
    return advance_if_passive(state, model, integrator->step_s, samples, zeta, by);
}

static laconic_status exponential_kahan_prepare(laconic_integrator *integrator, const laconic_model *model,
                                                laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 1);
    return LACONIC_OK;
}

const laconic_method laconic_exponential_kahan = {"exponential-kahan", 2, PREPARE(exponential_kahan_prepare),
                                                  exponential_kahan_step};

/* ------------------------------------------------------------------------- fourth order -- */

RARE increment kahan_4_varying(const laconic_model *model, const laconic_integrator *integrator,
                               const laconic_state *state, const laconic_forcing_samples *samples) {
    return extrapolated_varying(kahan_base, model, integrator, state, samples);
}

static laconic_status exponential_kahan_4_step(const laconic_model *model, const laconic_integrator *integrator,
                                               laconic_state *state, const laconic_forcing_samples *samples) {
    const vector zeta = zeta_of(state);
    const increment by = constant_over(samples) ? extrapolated(kahan_base, model, integrator, zeta, samples)
                                                : kahan_4_varying(model, integrator, state, samples);
    return advance_with_energy(state, model, integrator->step_s, samples, zeta, by);
}

static laconic_status exponential_kahan_4_prepare(laconic_integrator *integrator, const laconic_model *model,
                                                  laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 2);
    return LACONIC_OK;
}

const laconic_method laconic_exponential_kahan_4 = {"exponential-kahan-4", 4, PREPARE(exponential_kahan_4_prepare),
                                                    exponential_kahan_4_step};
