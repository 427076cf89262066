/* Several directions side by side: the same operations on the lanes of one processor register, with the bits of each
 * direction by itself. Where compilers have no such registers there is one lane. */
#ifndef LACONIC_DIRECTION_LANES_H
#define LACONIC_DIRECTION_LANES_H

#include "vector.h"

#if defined(__GNUC__) && !defined(LACONIC_ONE_DIRECTION) && \
    (defined(__SSE2__) || defined(__ARM_NEON) || defined(__wasm_simd128__))
#define LANES ((int)(16 / sizeof(real)))
typedef real lane __attribute__((vector_size(16)));
static inline real lane_number(lane a, int k) { return a[k]; }
static inline void set_lane(lane *a, int k, real x) { (*a)[k] = x; }
#else
#define LANES 1
typedef real lane;
static inline real lane_number(lane a, int k) { return (void)k, a; }
static inline void set_lane(lane *a, int k, real x) { (void)k, *a = x; }
#endif

/* Three numbers in each lane. */
typedef struct lanes {
    lane x, y, z;
} lanes;

static inline lane lane_of(real x) {
    lane a;
    for (int k = 0; k < LANES; k++) set_lane(&a, k, x);
    return a;
}

static inline lanes lanes_with(lane x, lane y, lane z) {
    const lanes out = {x, y, z};
    return out;
}

static inline bool lanes_same(lanes a, lanes b) {
    bool same = true;
    for (int k = 0; k < LANES; k++)
        same = same && lane_number(a.x, k) == lane_number(b.x, k) && lane_number(a.y, k) == lane_number(b.y, k) &&
               lane_number(a.z, k) == lane_number(b.z, k);
    return same;
}

/* The same vector in every lane. */
static inline lanes lanes_of(vector v) { return lanes_with(lane_of(v.x), lane_of(v.y), lane_of(v.z)); }

static inline lanes no_lanes(void) { return lanes_of(none); }

static inline vector lane_vector(lanes a, int k) {
    return vector_of(lane_number(a.x, k), lane_number(a.y, k), lane_number(a.z, k));
}

static inline void set_lane_vector(lanes *a, int k, vector v) {
    set_lane(&a->x, k, v.x);
    set_lane(&a->y, k, v.y);
    set_lane(&a->z, k, v.z);
}

static inline lanes lanes_plus(lanes a, lanes b) { return lanes_with(a.x + b.x, a.y + b.y, a.z + b.z); }

static inline lanes lanes_minus(lanes a, lanes b) { return lanes_with(a.x - b.x, a.y - b.y, a.z - b.z); }

static inline lanes lanes_scaled(real factor, lanes a) { return lanes_with(factor * a.x, factor * a.y, factor * a.z); }

/* a + factor·b */
static inline lanes lanes_added(lanes a, real factor, lanes b) { return lanes_plus(a, lanes_scaled(factor, b)); }

/* diag(a) b */
static inline lanes lanes_times(vector a, lanes b) { return lanes_with(a.x * b.x, a.y * b.y, a.z * b.z); }

static inline lane lanes_dot(vector a, lanes b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* A vector that each lane scales. */
static inline lanes lanes_along(lane factor, vector a) { return lanes_with(factor * a.x, factor * a.y, factor * a.z); }

static inline lanes lanes_cross(lanes a, vector b) {
    return lanes_with(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

#endif
