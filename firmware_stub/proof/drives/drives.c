/* Drives between any frames at any times, for Frama-C's analyser: of each protocol, from a plan that
 * laconic_drive_plan_check() lets pass. The functions of the plant, which entries of their own follow, stand as what
 * they may leave. */
#include "laconic_drives/drives.h"

#include "laconic_node/node.h"

#include "../any_frame.h"

/* Each step adds less than 2^32 counts, so an encoder needs 2^31 steps to come here. */
#define MOST_COUNTS (1LL << 62)

static laconic_drive_plan plan;
static laconic_drives drives;
static laconic_plant plant;
static laconic_input held;
static laconic_refusal refusal;
static uint64_t axes[(LACONIC_MAX_WHEELS * LACONIC_NODE_AXIS_BYTES + 7) / 8];

static void any_motion(void) {
    ANYTHING(plant);
    plant.model.wheel_count = Frama_C_interval(0, LACONIC_MAX_WHEELS);
    plant.model.dof = Frama_C_interval(1, 3);
    plant.model.rotated_twice = ANY_BOOL();
    plant.model.sloped = ANY_BOOL();
    plant.friction.acts = ANY_BOOL();
    plant.friction.slips = ANY_BOOL();
    plant.friction.wheel_count = plant.model.wheel_count;
}

laconic_status laconic_plant_run(laconic_plant *of, const laconic_input *input, uint64_t steps, laconic_refusal *why) {
    (void)of;
    (void)input;
    (void)steps;
    (void)why;
    any_motion();
    return (laconic_status)Frama_C_interval(0, LACONIC_STATUS_COUNT - 1);
}

void laconic_plant_wheel_speeds(const laconic_plant *of, laconic_real *speed_rad_per_s) {
    (void)of;
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) ANYTHING(speed_rad_per_s[i]);
}

void laconic_plant_wheel_angles(const laconic_plant *of, laconic_real *angle_rad) {
    (void)of;
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) ANYTHING(angle_rad[i]);
}

static void encoders_in_range(void) {
    for (int32_t k = 0; k < LACONIC_MAX_WHEELS; k++)
        if (drives.drive[k].encoder.count < -MOST_COUNTS || drives.drive[k].encoder.count > MOST_COUNTS)
            drives.drive[k].encoder.count = 0;
}

static void follow(const laconic_drive_protocol *protocol) {
    any_motion();
    ANYTHING(plan);
    if (laconic_drive_plan_check(&plan, protocol, plant.model.wheel_count, &refusal) != LACONIC_OK) return;
    laconic_drives_start(&drives, &plan, protocol, axes, &plant, ANY_WORD());
    while (ANY_BOOL()) {
        any_frame();
        ANYTHING(held);
        encoders_in_range();
        laconic_drives_on_frame(&drives, &frame, ANY_WORD());
        (void)laconic_drives_step(&drives, &plant, &held, ANY_WORD(), &refusal);
        (void)laconic_drives_next_frame(&drives, &frame);
        laconic_drive_order(&drives.drive[Frama_C_interval(0, LACONIC_MAX_WHEELS - 1)], ANY_WORD());
        if (ANY_BOOL()) laconic_drives_off(&drives);
    }
}

void prove_drives_by_canopen(void) { follow(&laconic_canopen); }
void prove_drives_by_odrive(void) { follow(&laconic_odrive); }
void prove_drives_by_robomaster(void) { follow(&laconic_robomaster); }
void prove_drives_by_moteus(void) { follow(&laconic_moteus); }

void prove_drive_plan(void) {
    const laconic_drive_protocol *protocol =
        laconic_drive_protocol_by_number(Frama_C_interval(-2147483647 - 1, 2147483647));
    laconic_drive_plan_begin(&plan);
    ANYTHING(plan);
    if (protocol != NULL)
        (void)laconic_drive_plan_check(&plan, protocol, Frama_C_interval(0, LACONIC_MAX_WHEELS), &refusal);
}

void prove_drive(void) {
    static laconic_wheel_drive drive;
    laconic_real turned_rad, speed_rad_per_s, step_s;
    ANYTHING(plan);
    ANYTHING(turned_rad);
    ANYTHING(speed_rad_per_s);
    ANYTHING(step_s);
    plan.drive[0].encoder_counts = Frama_C_interval(1, 2147483647);
    laconic_drive_start(&drive, &plan.drive[0]);
    ANYTHING(drive.target);
    drive.target.mode = (laconic_drive_mode)Frama_C_interval(0, 3);
    drive.encoder.count = Frama_C_long_long_interval(-MOST_COUNTS, MOST_COUNTS);
    (void)laconic_drive_act(&drive, step_s);
    laconic_drive_measure(&drive, turned_rad, speed_rad_per_s);
    (void)laconic_drive_shaft_count(&drive);
    laconic_drive_break(&drive, ANY_WORD());
    laconic_drive_mend(&drive, ANY_WORD());
    laconic_drive_clear(&drive);
}
