/* Normal loads of a vehicle whose wheels may lift: least-norm statics of the points that stay on the ground. */
#include "friction_vehicle.h"
#include "least_norm.h"

#if LACONIC_WITH_FRICTION
/* Below it, relative to the weight, a negative load is rounding. */
#define LIFTS (-LACONIC_RANK_TOLERANCE)

typedef struct balance { /* R Σ N, Σ N ξ, Σ N η */
    real wanted[3];
} balance;

/* Loads by `solver` of the points that are not lifted yet; returns whether another one lifts. */
static bool share(normal_loads *loads, const laconic_friction *f, const real solver[][3], const balance *b,
                  bool lifted[]) {
    bool another = false;
    for (int32_t i = 0; i < f->point_count; i++) {
        if (lifted[i]) continue;
        loads->statics_N[i] = loads->carried_N[i] = dot(vec(solver[i]), vec(b->wanted));
        if (loads->statics_N[i] >= LIFTS * f->weight_N) continue;
        lifted[i] = another = true;
        loads->carried_N[i] = R(0);
    }
    return another;
}

/* Where the points left cannot hold the moment (the vehicle tips over), they carry the weight all the same. */
static void carry_weight(normal_loads *loads, const laconic_friction *f) {
    real sum = R(0);
    for (int32_t i = 0; i < f->point_count; i++) {
        if (loads->carried_N[i] < R(0)) loads->carried_N[i] = R(0); /* rounding */
        sum += loads->carried_N[i];
    }
    for (int32_t i = 0; i < f->point_count && sum > R(0); i++) loads->carried_N[i] *= f->weight_N / sum;
}

RARE void share_again(normal_loads *loads, const laconic_friction *f, const balance *b, bool lifted[]) {
    real rows[LACONIC_SLIP_POINTS][3], solver[LACONIC_SLIP_POINTS][3];
    do {
        for (int32_t i = 0; i < f->point_count; i++)
            for (int k = 0; k < 3; k++) rows[i][k] = lifted[i] ? R(0) : f->point_row[i][k];
        laconic_least_norm(solver, (const real(*)[3])rows, f->point_count);
    } while (share(loads, f, (const real(*)[3])solver, b, lifted)); /* ends: each round lifts a point */
    carry_weight(loads, f);
}

void laconic_normal_loads(normal_loads *loads, const laconic_friction *friction, const real ground_N[2]) {
    const balance b = {
        {friction->radius_m * friction->weight_N, -friction->com_z_m * ground_N[0], -friction->com_z_m * ground_N[1]}};
    bool lifted[LACONIC_SLIP_POINTS] = {false};
    if (share(loads, friction, friction->normal_load_of_wrench, &b, lifted))
        share_again(loads, friction, &b, lifted);
    else
        carry_weight(loads, friction);
}

#endif
