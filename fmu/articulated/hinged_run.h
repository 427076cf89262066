/* What both models of vehicles with hinges do the same way: steps with the input held or moving, and what steps change,
 * saved and restored. The model that includes this file defines the functions that are only declared here. */
#ifndef LACONIC_FMU_ARTICULATED_HINGED_RUN_H
#define LACONIC_FMU_ARTICULATED_HINGED_RUN_H

#include "core_words.h"

/* These do not compile unless the core computes in double, kinds can be read as an int32_t and inputs are numbers. */
typedef char fmu_core_is_double[sizeof(laconic_real) == sizeof(double) ? 1 : -1];
typedef char fmu_kinds_are_int32
    [sizeof(laconic_hinge_kind) == sizeof(int32_t) && sizeof(laconic_wheel_kind) == sizeof(int32_t) ? 1 : -1];
typedef char fmu_input_is_all_doubles[sizeof(fmu_hinged_input) % sizeof(double) == 0 ? 1 : -1];

/* An internal step with the input as it is; and the one after `before` others, with an input that moves. */
static laconic_status step_held(fmu_model *self, laconic_refusal *why);
static laconic_status step_moving(fmu_model *self, uint64_t before, laconic_refusal *why);

/* Whether the input has derivatives beside its slopes. */
static bool input_has_rates(const fmu_model *self);

/* The input after so many steps in which it moved. Slopes hold for one communication step. */
static void end_after(fmu_model *self, uint64_t steps);

/* What else a run changes: outputs are stale. */
static void mark_as_run(fmu_model *self);

static laconic_refusal no_refusal(void) {
    const laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    return why;
}

static bool any_is_not_0(const double *numbers, size_t count) {
    bool is_any = false;
    for (size_t k = 0; k < count; k++) is_any = is_any || numbers[k] != 0.0;
    return is_any;
}

/* The input `by_s` later, by the slopes of FMI 2. */
static void shift_by_slope(fmu_hinged_input *out, const fmu_model *self, double by_s) {
    const double *u = (const double *)&self->input, *du = (const double *)&self->slope;
    double *shifted = (double *)out;
    for (size_t k = 0; k < sizeof *out / sizeof(double); k++) shifted[k] = u[k] + by_s * du[k];
}

/* Whether the importer lets the run go on; it is asked less often where steps are cheap. */
static bool goes_on(const fmu_instance *instance, bool moves, uint64_t taken) {
    return !instance->cancelled || (!moves && taken % FMU_MODEL_SLICE_STEPS != 0);
}

fmu_status fmu_model_run(fmu_instance *instance, uint64_t steps, uint64_t *taken) {
    fmu_model *self = &instance->model;
    const bool moves =
        input_has_rates(self) || any_is_not_0((const double *)&self->slope, sizeof self->slope / sizeof(double));
    laconic_refusal why = no_refusal();
    laconic_status status = LACONIC_OK;
    *taken = 0;
    while (*taken < steps && goes_on(instance, moves, *taken)) {
        status = moves ? step_moving(self, *taken, &why) : step_held(self, &why);
        if (status != LACONIC_OK) break;
        ++*taken;
    }
    if (moves && status == LACONIC_OK) end_after(self, *taken);
    mark_as_run(self);
    return status == LACONIC_OK ? FMU_OK : fmu_discard_with(instance, &why);
}

void fmu_model_settle_warnings(fmu_instance *instance, bool accepted) {
    (void)instance;
    (void)accepted; /* steps of such a vehicle have no warnings */
}

void fmu_model_completed_step(fmu_instance *instance) { (void)instance; }

void fmu_model_save_motion(const fmu_model *model, fmu_model_motion *motion) {
    motion->state = model->state;
    motion->input = model->input;
    motion->slope = model->slope;
}

void fmu_model_restore_motion(fmu_model *model, const fmu_model_motion *motion) {
    model->state = motion->state;
    model->input = motion->input;
    model->slope = motion->slope;
    model->stale = FMU_GROUPS_OF_STATE;
}

/* The origin of the body frame, and the heading within a turn. */
static void show_origin(fmu_model *self, const laconic_articulated_motion *motion) {
    double from_origin[2];
    fmu_turn(from_origin, &self->state.heading, self->prepared.com_x_m, self->prepared.com_y_m);
    self->origin_m[0] = motion->x_m - from_origin[0];
    self->origin_m[1] = motion->y_m - from_origin[1];
    self->heading_wrapped_rad = laconic_angle_wrapped(motion->heading_rad);
}

#endif
