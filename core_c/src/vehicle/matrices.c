/* Ξ, A, A⁻¹ and the constraint rows as the paper writes them, to read and for reactions; steps do not need them. */
#include "geometry.h"
#include "vector.h"

static void collect_rows(laconic_matrices *x, const body *b, const laconic_vehicle *vehicle) {
    for (int32_t i = 0; i < vehicle->wheel_count; i++) {
        laconic_wheel_row(x->wheel_rows[i], b, &vehicle->wheel[i]);
        x->constraint_count += laconic_constraint_rows(x->constraint_rows + x->constraint_count, b, &vehicle->wheel[i]);
    }
}

/* A = E + Σ J_i/(M R²) Ξ_iᵀ Ξ_i (4.6); with the rows of locked wheels, whose rotation the constraints prevent. */
static void form_inertia(laconic_matrices *x, const body *b, const laconic_vehicle *vehicle) {
    real share[LACONIC_MAX_WHEELS];
    laconic_inertia_shares(share, vehicle);
    for (int32_t r = 0; r < 3; r++)
        for (int32_t c = 0; c < 3; c++) {
            real sum = R(0);
            for (int32_t i = 0; i < vehicle->wheel_count; i++)
                sum += share[i] * x->wheel_rows[i][r] * x->wheel_rows[i][c];
            x->inertia[r][c] = (r == c ? R(1) : R(0)) + b->wheel_scale_square * sum;
        }
}

/* The check of the model does not cover rows of locked wheels and constraint rows, which it does not contain. */
static real matrices_size(const laconic_matrices *x, int32_t wheel_count) {
    return rows_size(x->wheel_rows, wheel_count) + rows_size(x->inertia, 3) + rows_size(x->inverse_inertia, 3) +
           rows_size(x->constraint_rows, x->constraint_count) + x->lambda_wheel;
}

laconic_status laconic_matrices_of(laconic_matrices *matrices, const laconic_vehicle *vehicle, laconic_refusal *why) {
    laconic_matrices x = ALL_ZERO;
    laconic_model model;
    body b;
    const laconic_status status = laconic_prepare(&model, vehicle, why);
    if (status != LACONIC_OK) return status;
    laconic_body_of(&b, vehicle);
    collect_rows(&x, &b, vehicle);
    form_inertia(&x, &b, vehicle);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) x.inverse_inertia[r][c] = dot(vec(model.nu_of_zeta[r]), vec(model.nu_of_zeta[c]));
    x.lambda_yaw = b.yaw_scale;
    x.lambda_wheel = laconic_root(b.wheel_scale_square);
    if (!fits_squared(matrices_size(&x, vehicle->wheel_count)))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
    *matrices = x;
    return LACONIC_OK;
}
