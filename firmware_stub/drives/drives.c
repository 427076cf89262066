/* The drives of one vehicle, and their join with its plant. */
#include "laconic_drives/drives.h"

#include <string.h>

/* ---------------------------------------------------------------------------- protocol -- */

/* A frame's time may be later than that of the tick that follows it; the protocol's clock then stands still. */
static uint32_t advance(laconic_drives *drives, uint32_t now_us) {
    if ((int32_t)(now_us - drives->now_us) > 0) drives->now_us = now_us;
    return drives->now_us;
}

void laconic_drives_on_frame(laconic_drives *drives, const laconic_frame *frame, uint32_t now_us) {
    drives->protocol->on_frame(drives, frame, advance(drives, now_us));
}

bool laconic_drives_next_frame(laconic_drives *drives, laconic_frame *frame) {
    return drives->protocol->next_frame(drives, frame);
}

void laconic_drives_off(laconic_drives *drives) {
    for (int32_t k = 0; k < drives->count; k++) laconic_drive_off(&drives->drive[k]);
}

/* ------------------------------------------------------------------------------- wheels -- */

static void measure(laconic_drives *drives, const laconic_plant *plant, const laconic_odometer *before) {
    laconic_real speed_rad_per_s[LACONIC_MAX_WHEELS];
    laconic_plant_wheel_speeds(plant, speed_rad_per_s);
    for (int32_t k = 0; k < drives->count; k++) {
        const int32_t i = drives->wheel[k];
        laconic_drive_measure(&drives->drive[k], laconic_wheel_turned_rad(plant, before, i), speed_rad_per_s[i]);
    }
}

/* ---------------------------------------------------------------------------------- start -- */

/* All drives off, without what they measure. */
static void begin(laconic_drives *drives, const laconic_drive_plan *plan, const laconic_drive_protocol *protocol,
                  void *axes, laconic_real step_s, uint32_t now_us) {
    memset(drives, 0, sizeof *drives);
    drives->protocol = protocol;
    drives->axes = axes;
    drives->step_s = step_s;
    drives->watchdog_s = plan->watchdog_s;
    drives->now_us = now_us;
    for (int32_t i = 0; i < LACONIC_DRIVE_AXES; i++) {
        if (plan->drive[i].node_id < 0) continue;
        drives->wheel[drives->count] = (uint8_t)i;
        laconic_drive_start(&drives->drive[drives->count++], &plan->drive[i]);
    }
}

static void begin_protocol(laconic_drives *drives, uint32_t now_us) {
    memset(drives->axes, 0, (size_t)drives->count * drives->protocol->axis_bytes);
    drives->protocol->start(drives, now_us);
}

void laconic_drives_start(laconic_drives *drives, const laconic_drive_plan *plan,
                          const laconic_drive_protocol *protocol, void *axes, const laconic_plant *plant,
                          uint32_t now_us) {
    laconic_odometer here;
    begin(drives, plan, protocol, axes, plant->integrator.step_s, now_us);
    laconic_odometer_of(&here, plant);
    measure(drives, plant, &here);
    begin_protocol(drives, now_us);
}

/* ------------------------------------------------------------------------ brakes by order -- */

/* Speed that a unit angular impulse on its axle gives a wheel; of a wheel that slips, without what the ground does. */
static laconic_real mobility(const laconic_plant *plant, int32_t wheel) {
    const laconic_real *row = plant->model.wheel_of_zeta[wheel];
#if LACONIC_WITH_FRICTION
    const laconic_real inertia = plant->friction.acts ? plant->friction.wheel[wheel].inertia : 0;
    if (inertia > 0) return plant->model.torque_scale / inertia;
#endif
    return (row[0] * row[0] + row[1] * row[1] + row[2] * row[2]) * plant->model.torque_scale;
}

laconic_real laconic_drive_brake(const laconic_wheel_drive *drive, const laconic_plant *plant, int32_t wheel,
                                 laconic_real speed_rad_per_s, laconic_real share) {
    const laconic_real gives = mobility(plant, wheel) * plant->integrator.step_s;
    const laconic_real most_Nm = drive->brake_Nm;
    if (!(gives > 0)) return 0;
    const laconic_real stops_Nm = -share * speed_rad_per_s / gives - drive->torque_Nm;
    return stops_Nm > most_Nm ? most_Nm : stops_Nm < -most_Nm ? -most_Nm : stops_Nm;
}

static void apply_brakes(const laconic_drives *drives, const laconic_plant *plant, laconic_input *input) {
    laconic_real speed_rad_per_s[LACONIC_MAX_WHEELS];
    laconic_real brakes = 0;
    for (int32_t k = 0; k < drives->count; k++) brakes += drives->drive[k].brake_Nm > 0 ? 1 : 0;
    if (!(brakes > 0)) return;
    laconic_plant_wheel_speeds(plant, speed_rad_per_s);
    for (int32_t k = 0; k < drives->count; k++) {
        const int32_t i = drives->wheel[k];
        if (drives->drive[k].brake_Nm > 0)
            input->axle_torque_Nm[i] +=
                laconic_drive_brake(&drives->drive[k], plant, i, speed_rad_per_s[i], 1 / brakes);
    }
}

/* --------------------------------------------------------------------------------- step -- */

laconic_status laconic_drives_step(laconic_drives *drives, laconic_plant *plant, laconic_input *held, uint32_t now_us,
                                   laconic_refusal *why) {
    laconic_odometer before;
    drives->protocol->on_step(drives, advance(drives, now_us));
    for (int32_t k = 0; k < drives->count; k++)
        held->axle_torque_Nm[drives->wheel[k]] = laconic_drive_act(&drives->drive[k], drives->step_s);
    if (LACONIC_NODE_WITH_DRIVE_FAULTS) apply_brakes(drives, plant, held); /* by order */
    laconic_odometer_of(&before, plant);
    const laconic_status status = laconic_plant_run(plant, held, 1, why);
    if (status != LACONIC_OK) {
        laconic_drives_off(drives);
        return status;
    }
    measure(drives, plant, &before);
    return LACONIC_OK;
}

/* -------------------------------------------------------------------------------- hinges -- */

#if LACONIC_NODE_WITH_HINGES

static laconic_real difference(const laconic_sum *a, const laconic_sum *b) {
    return (a->value - b->value) + (a->rest - b->rest);
}

#ifdef LACONIC_SINGLE
typedef int32_t signed_fraction;
#define RAD_PER_UNIT ((laconic_real)(3.14159265358979323846 / 2147483648.0)) /* π / 2³¹ */
#else
typedef int64_t signed_fraction;
#define RAD_PER_UNIT ((laconic_real)(3.14159265358979323846 / 9223372036854775808.0)) /* π / 2⁶³ */
#endif

/* How far a hinge has turned between two states, less than half a turn, with the resolution of a heading. */
static laconic_real turned_rad(const laconic_heading *before, const laconic_heading *after) {
    const signed_fraction whole = (signed_fraction)(after->fraction - before->fraction);
    return ((laconic_real)whole + 2 * (after->rest - before->rest)) * RAD_PER_UNIT;
}

/* How far a wheel has turned between two states. */
static laconic_real rolled_rad(const laconic_articulated_wheel *wheel, const laconic_articulated_state *before,
                               const laconic_articulated_state *after) {
    const laconic_sum *from = before->travel[wheel->body], *to = after->travel[wheel->body];
    return wheel->roll.x * difference(&to[0], &from[0]) + wheel->roll.y * difference(&to[1], &from[1]) +
           wheel->roll.z * difference(&to[2], &from[2]);
}

void laconic_drives_measure_with_hinges(laconic_drives *drives, const laconic_articulated_model *model,
                                        const laconic_articulated_state *before,
                                        const laconic_articulated_state *after) {
    laconic_articulated_motion motion;
    laconic_articulated_motion_of(&motion, model, after);
    for (int32_t k = 0; k < drives->count; k++) {
        const int32_t i = drives->wheel[k], b = i - model->wheel_count;
        if (b < 0) {
            laconic_drive_measure(&drives->drive[k], rolled_rad(&model->wheel[i], before, after),
                                  motion.wheel_speed_rad_per_s[i]);
        } else {
            laconic_drive_measure(&drives->drive[k], turned_rad(&before->hinge[b], &after->hinge[b]),
                                  motion.hinge_rate_rad_per_s[b]);
        }
    }
}

void laconic_drives_start_with_hinges(laconic_drives *drives, const laconic_drive_plan *plan,
                                      const laconic_drive_protocol *protocol, void *axes,
                                      const laconic_articulated_model *model, const laconic_articulated_state *state,
                                      laconic_real step_s, uint32_t now_us) {
    begin(drives, plan, protocol, axes, step_s, now_us);
    laconic_drives_measure_with_hinges(drives, model, state, state);
    begin_protocol(drives, now_us);
}

void laconic_drives_act_with_hinges(laconic_drives *drives, const laconic_articulated_model *model, laconic_input *held,
                                    laconic_articulated_input input[2], uint32_t now_us) {
    drives->protocol->on_step(drives, advance(drives, now_us));
    for (int32_t k = 0; k < drives->count; k++) {
        const int32_t i = drives->wheel[k], b = i - model->wheel_count;
        laconic_wheel_drive *drive = &drives->drive[k];
        if (b < 0) {
            held->axle_torque_Nm[i] = laconic_drive_act(drive, drives->step_s);
        } else if (model->link[b].motion == LACONIC_MOTION_PRESCRIBED) {
            input[1].hinge_rate_rad_per_s[b] = laconic_drive_follow(drive);
        } else {
            const laconic_real torque_Nm = laconic_drive_act(drive, drives->step_s);
            for (int each = 0; each < 2; each++) input[each].hinge_torque_Nm[b] = torque_Nm;
        }
    }
}
#endif

/* ------------------------------------------------------------------------------- slipping -- */

#if LACONIC_NODE_WITH_SLIP

void laconic_drives_measure_slipping(laconic_drives *drives, const laconic_tree_model *model,
                                     const laconic_tree_state *before, const laconic_tree_state *after) {
    laconic_articulated_motion motion;
    laconic_tree_motion_of(&motion, model, after);
    for (int32_t k = 0; k < drives->count; k++) {
        const int32_t i = drives->wheel[k], b = i - model->wheel_count;
        if (b < 0) {
            laconic_drive_measure(&drives->drive[k],
                                  difference(&after->wheel_angle_rad[i], &before->wheel_angle_rad[i]),
                                  motion.wheel_speed_rad_per_s[i]);
        } else {
            laconic_drive_measure(&drives->drive[k], turned_rad(&before->hinge[b], &after->hinge[b]),
                                  motion.hinge_rate_rad_per_s[b]);
        }
    }
}

void laconic_drives_start_slipping(laconic_drives *drives, const laconic_drive_plan *plan,
                                   const laconic_drive_protocol *protocol, void *axes, const laconic_tree_model *model,
                                   const laconic_tree_state *state, laconic_real step_s, uint32_t now_us) {
    begin(drives, plan, protocol, axes, step_s, now_us);
    laconic_drives_measure_slipping(drives, model, state, state);
    begin_protocol(drives, now_us);
}

bool laconic_drives_brakes(const laconic_drives *drives, laconic_real brake_Nm[LACONIC_DRIVE_AXES]) {
    bool some = false;
    for (int32_t k = 0; k < drives->count; k++) {
        brake_Nm[k] = drives->drive[k].brake_Nm;
        some = some || brake_Nm[k] > 0;
    }
    return some;
}

void laconic_drives_exchange_dry_friction(const laconic_drives *drives, laconic_tree_model *model,
                                          laconic_real other_Nm[LACONIC_DRIVE_AXES]) {
    for (int32_t k = 0; k < drives->count; k++) {
        const int32_t i = drives->wheel[k], b = i - model->wheel_count;
        laconic_real *friction_Nm = b < 0 ? &model->wheel[i].dry_Nm : &model->body[b + 1].dry_friction_Nm;
        if (!(drives->drive[k].brake_Nm > 0)) continue;
        const laconic_real held_Nm = *friction_Nm;
        *friction_Nm = other_Nm[k];
        other_Nm[k] = held_Nm;
    }
}
#endif
