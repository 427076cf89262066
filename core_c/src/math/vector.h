/* Vectors of three numbers. Written out, since at -O2 compilers do not unroll loops of three. */
#ifndef LACONIC_VECTOR_H
#define LACONIC_VECTOR_H

#include "common.h"

typedef laconic_vector vector;

static const vector none = {ZERO, ZERO, ZERO};

static inline vector vector_of(real x, real y, real z) {
    const vector out = {x, y, z};
    return out;
}

static inline vector vec(const real v[3]) {
    const vector out = {v[0], v[1], v[2]};
    return out;
}

static inline void store(real out[3], vector v) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

static inline vector plus(vector a, vector b) {
    const vector out = {a.x + b.x, a.y + b.y, a.z + b.z};
    return out;
}

static inline vector minus(vector a, vector b) {
    const vector out = {a.x - b.x, a.y - b.y, a.z - b.z};
    return out;
}

static inline vector scaled(real factor, vector v) {
    const vector out = {factor * v.x, factor * v.y, factor * v.z};
    return out;
}

/* Each axis by its own factor: diag(a) b. */
static inline vector times(vector a, vector b) {
    const vector out = {a.x * b.x, a.y * b.y, a.z * b.z};
    return out;
}

static inline real dot(vector a, vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* |v|²: not finite as soon as one component is not. */
static inline real square(vector v) { return dot(v, v); }

static inline vector cross(vector a, vector b) {
    const vector out = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return out;
}

/* |v|₁ */
static inline real size(vector v) { return magnitude(v.x) + magnitude(v.y) + magnitude(v.z); }

/* Σ|v| over rows of three. */
static inline real rows_size(const real rows[][3], int32_t count) {
    real sum = R(0);
    for (int32_t i = 0; i < count; i++) sum += size(vec(rows[i]));
    return sum;
}

/* Products of two such numbers, of one model or of two, stay in the range. False for NaN. */
static inline mask fits_squared(real sum_of_sizes) { return is_finite(sum_of_sizes * sum_of_sizes); }

#endif
