/* Derivatives of the last communication step: of the outputs at its end with respect to the states at its start and the
 * inputs held over it. The step is kept by what it began with; its Jacobian is computed when it is asked for, from the
 * core's derivatives of its internal steps. */
#include <string.h>

#include "laconic/derivatives.h"
#include "model_interface.h"

#define STATE_COLUMNS 4 /* by ν and by the heading: x, y and wheel angles at the start shift those at the end */
#define MOST_COLUMNS (STATE_COLUMNS + LACONIC_INPUT_NUMBERS(LACONIC_MAX_WHEELS))

void fmu_model_begin_step(fmu_model *model) {
    model->next.kept = model->sloped ? FMU_STEP_SLOPED : FMU_STEP_KEPT;
    model->next.state = model->plant.state;
    model->next.input = model->input;
    model->next.step_s = model->plant.integrator.step_s;
    model->next.steps = model->plant.steps;
}

/* A remainder of time, which takes no internal step, leaves the last one as it was. */
void fmu_model_end_step(fmu_model *model, fmu_status status) {
    if (status != FMU_OK || model->plant.steps == model->next.steps) return;
    model->last = model->next;
    model->last.steps = model->plant.steps - model->next.steps;
    model->has_jacobian = false;
}

void fmu_model_spoil_step(fmu_model *model, int32_t reason) {
    if (reason == FMU_STEP_TOUCHED) model->next.kept = reason;
    if (reason == FMU_STEP_CHANGED && model->last.kept != FMU_STEP_NONE) model->last.kept = reason;
}

/* Elsewhere the derivatives are those at the instant. */
static bool asks_for_step(const fmu_instance *instance) {
    const bool after_step = instance->mode == FMU_STEP || instance->mode == FMU_TERMINATED;
    return after_step && instance->kind == FMU_CO_SIMULATION && instance->model.last.kept != FMU_STEP_NONE;
}

/* ------------------------------------------------------------------------------- its Jacobian -- */

typedef struct column_list {
    laconic_state_change *column[MOST_COLUMNS];
    int32_t count;
} column_list;

static void add_columns(column_list *list, laconic_state_change *first, int32_t count) {
    for (int32_t k = 0; k < count; k++) list->column[list->count++] = &first[k];
}

/* By ν, by the heading, then by the inputs in their order. */
static column_list columns_of(laconic_step_jacobian *j, int32_t wheels) {
    column_list list;
    list.count = 0;
    add_columns(&list, j->by_nu, 3);
    add_columns(&list, &j->by_heading, 1);
    add_columns(&list, j->by_voltage, wheels);
    add_columns(&list, j->by_axle_torque, wheels);
    add_columns(&list, j->by_body_force, 2);
    add_columns(&list, &j->by_body_moment, 1);
    add_columns(&list, j->by_world_force, 2);
    add_columns(&list, j->by_world_force_point, 2);
    return list;
}

/* What is 0 is left out, so that a unit vector gives the bits of its column. */
static void add_scaled(laconic_state_change *sum, double factor, const laconic_state_change *by, int32_t wheels) {
    if (factor == 0.0) return;
    for (int32_t k = 0; k < 3; k++) sum->nu_rad_per_s[k] += factor * by->nu_rad_per_s[k];
    sum->x_m += factor * by->x_m;
    sum->y_m += factor * by->y_m;
    sum->heading_rad += factor * by->heading_rad;
    for (int32_t i = 0; i < wheels; i++) sum->wheel_angle_rad[i] += factor * by->wheel_angle_rad[i];
}

/* A change of the state before an internal step becomes that after it. */
static void carry(laconic_state_change *change, const column_list *one, int32_t wheels) {
    const laconic_state_change before = *change;
    for (int32_t k = 0; k < 3; k++) change->nu_rad_per_s[k] = 0.0;
    change->heading_rad = 0.0;
    for (int32_t k = 0; k < 3; k++) add_scaled(change, before.nu_rad_per_s[k], one->column[k], wheels);
    add_scaled(change, before.heading_rad, one->column[3], wheels);
}

static bool add_step(laconic_step_jacobian *sum, laconic_plant *plant, const laconic_input *held) {
    const int32_t wheels = plant->model.wheel_count;
    const column_list whole = columns_of(sum, wheels);
    laconic_step_jacobian step;
    if (laconic_step_jacobian_of(&step, &plant->model, &plant->integrator, &plant->state, held, true) != LACONIC_OK)
        return false;
    const column_list one = columns_of(&step, wheels);
    for (int32_t c = 0; c < whole.count; c++) {
        carry(whole.column[c], &one, wheels);
        if (c >= STATE_COLUMNS) add_scaled(whole.column[c], 1.0, one.column[c], wheels);
    }
    return laconic_step(&plant->model, &plant->integrator, &plant->state, held) == LACONIC_OK;
}

/* False where the core refuses what it did not refuse when it took the step: that of a state which was no run's. */
static bool find_jacobian(fmu_model *self) {
    laconic_plant plant = self->plant;
    const laconic_step_jacobian nothing = {0};
    plant.state = self->last.state;
    if (plant.integrator.step_s != self->last.step_s && /* a refused step of another length came after it */
        laconic_plant_set_step(&plant, self->last.step_s, NULL) != LACONIC_OK)
        return false;
    self->jacobian = nothing;
    for (int32_t k = 0; k < 3; k++) self->jacobian.by_nu[k].nu_rad_per_s[k] = 1.0;
    self->jacobian.by_heading.heading_rad = 1.0;
    for (uint64_t n = 0; n < self->last.steps; n++)
        if (!add_step(&self->jacobian, &plant, &self->last.input)) return false;
    return true;
}

fmu_status fmu_model_check_step(fmu_instance *instance) {
    static const char *const reasons[FMU_STEP_KINDS] = {
        NULL, "the core refuses them", "its inputs had slopes, and derivatives are by inputs that are held",
        "inputs were set within it, and derivatives are by inputs that are held",
        "the vehicle has changed since; take another step first"};
    fmu_model *self = &instance->model;
    if (!asks_for_step(instance)) return FMU_OK;
    if (self->last.kept == FMU_STEP_KEPT && !self->has_jacobian) self->has_jacobian = find_jacobian(self);
    if (self->last.kept == FMU_STEP_KEPT && self->has_jacobian) return FMU_OK;
    return fmu_refuse(instance, "the last communication step has no derivatives: %s", reasons[self->last.kept]);
}

/* ---------------------------------------------------------------------------------- a response -- */

/* Seeds in the order of the columns. */
static void take_seeds(double seed[MOST_COLUMNS], const fmu_tangent *t, int32_t wheels) {
    const laconic_input *u = &t->input;
    int32_t n = 0;
    for (int32_t k = 0; k < 3; k++) seed[n++] = t->nu[k];
    seed[n++] = t->heading_rad;
    for (int32_t i = 0; i < wheels; i++) seed[n++] = u->voltage_V[i];
    for (int32_t i = 0; i < wheels; i++) seed[n++] = u->axle_torque_Nm[i];
    for (int32_t k = 0; k < 2; k++) seed[n++] = u->body_force_N[k];
    seed[n++] = u->body_moment_Nm;
    for (int32_t k = 0; k < 2; k++) seed[n++] = u->world_force_N[k];
    for (int32_t k = 0; k < 2; k++) seed[n++] = u->world_force_point_m[k];
}

static void put_states(fmu_tangent *t, const laconic_state_change *change, int32_t wheels) {
    for (int32_t k = 0; k < 3; k++) t->nu[k] = change->nu_rad_per_s[k];
    t->x_m += change->x_m;
    t->y_m += change->y_m;
    t->heading_rad = change->heading_rad;
    for (int32_t i = 0; i < wheels; i++) t->wheel_angle_rad[i] += change->wheel_angle_rad[i];
}

/* Seeds of the states at the start become changes of those at the end. */
static void respond_states(fmu_model *self, fmu_tangent *t) {
    const int32_t wheels = self->plant.model.wheel_count;
    const column_list list = columns_of(&self->jacobian, wheels);
    laconic_state_change change = {{0.0}, 0.0, 0.0, 0.0, {0.0}};
    double seed[MOST_COLUMNS];
    take_seeds(seed, t, wheels);
    for (int32_t c = 0; c < list.count; c++) add_scaled(&change, seed[c], list.column[c], wheels);
    put_states(t, &change, wheels);
}

/* The outputs are those at the step's end, with the input held until then. */
void fmu_model_step_tangent(fmu_instance *instance, fmu_tangent *tangent) {
    fmu_model *self = &instance->model;
    if (!asks_for_step(instance)) {
        fmu_model_tangent(instance, tangent);
        return;
    }
    const laconic_input now = self->input;
    respond_states(self, tangent);
    self->input = self->last.input;
    self->stale |= FMU_GROUPS_OF_INPUT;
    fmu_model_tangent(instance, tangent);
    self->input = now;
    self->stale |= FMU_GROUPS_OF_INPUT;
}
