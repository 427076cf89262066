/* Parts of preparing a tree: what its numbers mean, and checks of them. */
#ifndef LACONIC_TREE_VEHICLE_H
#define LACONIC_TREE_VEHICLE_H

#include "geometry.h"
#include "tree_posture.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

static inline bool tree_has_servo(const laconic_tree_hinge *hinge) {
    return hinge->servo_gain_Nm_per_rad > R(0) || hinge->servo_damping_Nms > R(0);
}

static inline bool tree_has_loop(const laconic_tree_hinge *hinge) {
    return hinge->loop_V_per_rad != R(0) || hinge->loop_Vs_per_rad != R(0);
}

static inline bool tree_has_stops(const laconic_tree_hinge *hinge) {
    return hinge->stop_low_rad != R(0) || hinge->stop_high_rad != R(0);
}

/* Every number by itself, and what hinges and wheels need of each other. */
laconic_status laconic_tree_check(const laconic_tree_vehicle *vehicle, laconic_refusal *why);

#endif
#endif
