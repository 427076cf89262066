/* Functions for tests and the in-process rig, beside those of the node. */
#include "shared_library.h"

#include "laconic_node/node.h"
#include "laconic_wire.h"
#include "node_internal.h"

uint32_t laconic_library_node_size(void) { return (uint32_t)sizeof(laconic_node); }

bool laconic_library_node_init(laconic_node *node, uint16_t id_base, bool can_fd, uint32_t nonce_seed,
                               uint32_t now_us) {
    const laconic_node_config config = {id_base, can_fd, laconic_method_by_number, nonce_seed,
                                        laconic_drive_protocol_by_number};
    return laconic_node_init(node, &config, now_us);
}

void laconic_library_inspect(const laconic_node *node, laconic_library_view *view) {
    const laconic_library_view copy = {
        .state = node->state,
        .deaf = node->session.deaf != 0,
        .steps = node->plant.steps,
        .voltage_V = {(double)node->input[0].voltage_V[0], (double)node->input[0].voltage_V[1],
                      (double)node->input[0].voltage_V[2]},
        .counters = node->counters,
    };
    *view = copy;
}

#if LACONIC_NODE_WITH_HINGES
static void motion_with_hinges(const laconic_node *node, laconic_library_motion *motion) {
    laconic_articulated_motion now;
    laconic_node_motion_of(&now, node);
    const laconic_library_motion copy = {
        .x_m = (double)now.x_m,
        .y_m = (double)now.y_m,
        .heading_rad = (double)now.heading_rad,
        .velocity_m_per_s = {(double)now.velocity_m_per_s[0], (double)now.velocity_m_per_s[1]},
        .yaw_rate_rad_per_s = (double)now.yaw_rate_rad_per_s,
    };
    *motion = copy;
}

/* Angle and speed of an axis: a wheel, or behind the last a hinge. */
static void axis_with_hinges(const laconic_node *node, int32_t axis, laconic_real *angle, laconic_real *speed) {
    const int32_t hinge = axis - node->hinges.model.wheel_count;
    laconic_articulated_motion now;
    laconic_node_motion_of(&now, node);
    *angle = hinge < 0 ? now.wheel_angle_rad[axis] : now.hinge_angle_rad[hinge];
    *speed = hinge < 0 ? now.wheel_speed_rad_per_s[axis] : now.hinge_rate_rad_per_s[hinge];
}
#endif

void laconic_library_motion_of(const laconic_node *node, laconic_library_motion *motion) {
#if LACONIC_NODE_WITH_HINGES
    if (node->hinges.here) {
        motion_with_hinges(node, motion);
        return;
    }
#endif
    const laconic_model *model = &node->plant.model;
    const laconic_state *state = &node->plant.state;
    laconic_pose pose;
    laconic_real velocity[2];
    laconic_pose_of(&pose, model, state);
    const double yaw_rate = (double)laconic_body_velocity(model, state, velocity);
    const laconic_library_motion copy = {
        .x_m = (double)pose.x_m,
        .y_m = (double)pose.y_m,
        .heading_rad = (double)pose.heading_rad,
        .velocity_m_per_s = {(double)velocity[0], (double)velocity[1]},
        .yaw_rate_rad_per_s = yaw_rate,
    };
    *motion = copy;
}

int32_t laconic_library_drive_count(const laconic_node *node) { return node->drives.count; }

bool laconic_library_drive_view(const laconic_node *node, int32_t drive, laconic_library_drive *view) {
    laconic_real speed[LACONIC_DRIVE_AXES];
    laconic_real angle[LACONIC_DRIVE_AXES];
    if (drive < 0 || drive >= node->drives.count) return false;
    const laconic_wheel_drive *it = &node->drives.drive[drive];
    const int32_t wheel = node->drives.wheel[drive];
    laconic_real axle_torque = wheel < LACONIC_MAX_WHEELS ? node->input[0].axle_torque_Nm[wheel] : 0;
#if LACONIC_NODE_WITH_HINGES
    const int32_t hinge = wheel - node->hinges.model.wheel_count;
    if (node->hinges.here) {
        axis_with_hinges(node, wheel, &angle[wheel], &speed[wheel]);
        if (hinge >= 0) axle_torque = node->hinges.input[0].hinge_torque_Nm[hinge];
    } else
#endif
    {
        laconic_plant_wheel_speeds(&node->plant, speed);
        laconic_plant_wheel_angles(&node->plant, angle);
    }
    const laconic_library_drive copy = {
        .wheel = wheel,
        .node_id = it->settings.node_id,
        .mode = (int32_t)it->target.mode,
        .target_count = it->target.position_count,
        .target_rest = (double)it->target.position_rest,
        .target_speed_rad_per_s = (double)it->target.speed_rad_per_s,
        .target_current_A = (double)it->target.current_A,
        .faults = it->faults,
        .unheard = it->unheard,
        .limits = it->limits,
        .count = it->encoder.count,
        .rest = (double)it->encoder.rest,
        .speed_rad_per_s = (double)it->speed_rad_per_s,
        .current_A = (double)it->current_A,
        .integral_A = (double)it->integral_A,
        .torque_Nm = (double)it->torque_Nm,
        .axle_torque_Nm = (double)axle_torque,
        .wheel_speed_rad_per_s = (double)speed[wheel],
        .wheel_angle_rad = (double)angle[wheel],
    };
    *view = copy;
    return true;
}

void laconic_library_drive_fail(laconic_node *node, int32_t drive, uint32_t faults) {
    laconic_drive_fail(&node->drives.drive[drive], faults);
}

void laconic_library_drive_break(laconic_node *node, int32_t drive, uint32_t faults) {
    laconic_drive_break(&node->drives.drive[drive], faults);
}

void laconic_library_drive_mend(laconic_node *node, int32_t drive, uint32_t faults) {
    laconic_drive_mend(&node->drives.drive[drive], faults);
}

void laconic_library_drive_brake(laconic_node *node, int32_t drive, double torque_Nm) {
    node->drives.drive[drive].brake_Nm = (laconic_real)torque_Nm;
}

void laconic_library_drive_order(laconic_node *node, int32_t drive, uint32_t orders) {
    laconic_drive_order(&node->drives.drive[drive], orders);
}

static void try_error(laconic_error_census *census, const uint8_t frame[8], uint64_t error, const uint8_t data_ids[16],
                      uint8_t max_delta) {
    uint8_t data[8];
    const uint8_t mask = LACONIC_E2E_P22_COUNTER_MASK;
    for (unsigned k = 0; k < 8; k++) data[k] = (uint8_t)(frame[k] ^ (error >> (8U * k) & 255U));
    laconic_e2e_receiver receiver = {.known = true, .counter = (uint8_t)((frame[1] - 1U) & mask)};
    const laconic_e2e_ends ends = {LACONIC_E2E_P22_START, data_ids[data[1] & mask]};
    const bool is_right = laconic_e2e_p22_crc_is_right(data, 8, ends);
    const laconic_e2e_status status = laconic_e2e_check(&receiver, is_right, data[1] & mask, mask, max_delta);
    uint64_t *counts = (data[1] & mask) == (frame[1] & mask) ? census->counter_kept : census->counter_changed;
    counts[!is_right ? 0 : laconic_e2e_accepts(status) ? 2 : 1]++;
}

void laconic_library_census(laconic_error_census *census, const uint8_t frame[8], const uint8_t data_ids[16],
                            uint8_t max_delta) {
    for (unsigned i = 0; i < 64; i++) {
        const uint64_t one = (uint64_t)1 << i;
        try_error(census, frame, one, data_ids, max_delta);
        for (unsigned j = i + 1; j < 64; j++) {
            const uint64_t two = one | (uint64_t)1 << j;
            try_error(census, frame, two, data_ids, max_delta);
            for (unsigned k = j + 1; k < 64; k++) try_error(census, frame, two | (uint64_t)1 << k, data_ids, max_delta);
        }
    }
}
