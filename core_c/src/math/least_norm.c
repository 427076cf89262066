/* Least-norm solutions of three equations: multipliers of constraints, normal loads. */
#include "least_norm.h"

#include "elementary.h"

/* Least-norm solution of Cᵀκ = f for rows C (n×3) of any rank: κ = C (CᵀC)⁺ f. The 3×3 pseudo-inverse comes
 * from the eigenvectors of S = CᵀC by cyclic Jacobi. */
typedef struct symmetric3 {
    real value[3][3], vector[3][3];
} symmetric3;

static void rotate(symmetric3 *s, int p, int q) {
    const real off = s->value[p][q];
    if (off == R(0)) return;
    const real cotangent = (s->value[q][q] - s->value[p][p]) / (R(2) * off);
    real tangent = R(1) / (magnitude(cotangent) + laconic_root(R(1) + cotangent * cotangent));
    if (cotangent < R(0)) tangent = -tangent;
    const real c = R(1) / laconic_root(R(1) + tangent * tangent);
    const real d = c * tangent;
    for (int k = 0; k < 3; k++) {
        const real kp = s->value[k][p], kq = s->value[k][q];
        s->value[k][p] = c * kp - d * kq;
        s->value[k][q] = d * kp + c * kq;
    }
    for (int k = 0; k < 3; k++) {
        const real pk = s->value[p][k], qk = s->value[q][k], vp = s->vector[k][p], vq = s->vector[k][q];
        s->value[p][k] = c * pk - d * qk;
        s->value[q][k] = d * pk + c * qk;
        s->vector[k][p] = c * vp - d * vq;
        s->vector[k][q] = d * vp + c * vq;
    }
}

static void pseudo_inverse(real out[3][3], const real matrix[3][3]) {
    symmetric3 s;
    real largest = R(0);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            s.value[r][c] = matrix[r][c];
            s.vector[r][c] = r == c ? R(1) : R(0);
            out[r][c] = R(0);
        }
    /* After four sweeps the rest off the diagonal is below 1e-17 of it (4,000 random matrices, rows over 12
     * decades); the other eight are a reserve that costs little in a preparation. */
    for (int k = 0; k < 12; k++) {
        rotate(&s, 0, 1);
        rotate(&s, 0, 2);
        rotate(&s, 1, 2);
    }
    for (int k = 0; k < 3; k++)
        if (s.value[k][k] > largest) largest = s.value[k][k];
    for (int k = 0; k < 3; k++) {
        if (!(s.value[k][k] > LACONIC_RANK_TOLERANCE * largest)) continue;
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) out[r][c] += s.vector[r][k] * s.vector[c][k] / s.value[k][k];
    }
}

void laconic_least_norm(real solver[][3], const real rows[][3], int32_t count) {
    real gram[3][3], inverse[3][3];
    for (int32_t r = 0; r < 3; r++)
        for (int32_t c = 0; c < 3; c++) {
            gram[r][c] = R(0);
            for (int32_t i = 0; i < count; i++) gram[r][c] += rows[i][r] * rows[i][c];
        }
    pseudo_inverse(inverse, (const real(*)[3])gram);
    for (int32_t i = 0; i < count; i++)
        for (int32_t c = 0; c < 3; c++)
            solver[i][c] = rows[i][0] * inverse[0][c] + rows[i][1] * inverse[1][c] + rows[i][2] * inverse[2][c];
}
