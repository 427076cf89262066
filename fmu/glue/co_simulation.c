/* One communication step: a whole number of internal steps, or a refusal that gives both lengths. */
#include <float.h>

#include "model_interface.h"

/* Communication steps that differ by less, relatively, differ by rounding and count as equal. */
#define SAME_STEP 1e-9

/* Importers add up their times and end a run with the remainder; up to this part of an internal step it is no step. */
#define NO_STEP 1e-6

/* Internal steps of one communication step at most, which take some minutes. Importers that can return early after each
 * internal step need no limit. */
#define MOST_STEPS 100000000U

/* With step_s = 0, the part of a communication step by which the importer's time may be wrong. */
#define OFF_WITHOUT_STEP 1e-3

/* With step_s = 0 the last communication step; 0: there was none yet. */
static double last_internal_step(const fmu_instance *instance) {
    const double own_s = fmu_model_own_step(&instance->model);
    return own_s > 0.0 ? own_s : instance->clock.step_s;
}

static bool is_remainder(const fmu_instance *instance, double step_s) {
    return step_s > 0.0 && step_s <= NO_STEP * last_internal_step(instance);
}

/* The internal step by which this communication step is taken. */
static double internal_step(const fmu_instance *instance, double step_s) {
    const double last_s = last_internal_step(instance);
    if (is_remainder(instance, step_s) || fmu_model_own_step(&instance->model) > 0.0) return last_s;
    return last_s > 0.0 && last_s < step_s ? last_s : step_s;
}

static double magnitude(double value) { return value < 0.0 ? -value : value; }

/* How far the importer's time may differ from the model's: half an internal step. With step_s = 0 the importer
 * chooses the step and half of it would be too much; there it is a thousandth of the step, plus the rounding of an
 * importer that has added up all steps since the start, and half a step at most. */
static double time_tolerance(const fmu_instance *instance, double at_s, double internal_s) {
    const fmu_clock *clock = &instance->clock;
    const double half_s = 0.5 * internal_s, last_s = clock->step_s > 0.0 ? clock->step_s : internal_s;
    if (fmu_model_own_step(&instance->model) > 0.0) return half_s;
    const double off_s = OFF_WITHOUT_STEP * internal_s +
                         DBL_EPSILON * magnitude(at_s) * (magnitude(instance->model.time_s - clock->start_s) / last_s);
    return off_s < half_s ? off_s : half_s;
}

static fmu_status check_interval(const fmu_instance *instance, double at_s, double step_s) {
    const fmu_clock *clock = &instance->clock;
    const double now_s = instance->model.time_s, off_s = at_s - now_s;
    const double internal_s = internal_step(instance, step_s), most_s = time_tolerance(instance, at_s, internal_s);
    if (!fmu_is_finite(step_s))
        return fmu_refuse(instance, "a communication step of %g s cannot be taken: it is not finite", step_s);
    if (!fmu_is_finite(at_s)) return fmu_refuse(instance, "the step starts at %g s: that is not finite", at_s);
    if (!(step_s > 0.0))
        return fmu_refuse(instance, "a communication step of %.15g s cannot be taken: it must be more than 0", step_s);
    if (!(off_s <= most_s && off_s >= -most_s)) return fmu_refuse_start(instance, at_s, now_s);
    if (fmu_clock_passes_stop(clock, now_s + step_s, internal_s))
        return fmu_refuse_end(instance, now_s, now_s + step_s);
    return FMU_OK;
}

static fmu_status change_step(fmu_instance *instance, double step_s) {
    const fmu_status status = fmu_model_set_step(instance, step_s);
    if (status == FMU_OK) fmu_clock_change_step(&instance->clock, step_s);
    return status;
}

static fmu_status check_count_of_steps(const fmu_instance *instance, double step_s, double own_s, uint64_t steps) {
    if (steps <= MOST_STEPS || (instance->between_steps != NULL && instance->early_return_allowed)) return FMU_OK;
    return fmu_refuse(instance,
                      "the communication step of %.15g s would be %.15g internal steps of %.15g s (step_s) without a "
                      "return: take %.15g s or less",
                      step_s, (double)steps, own_s, MOST_STEPS * own_s);
}

/* Counts the internal steps; the clock keeps the count for the next communication step of the same length. */
static fmu_status count_steps(fmu_instance *instance, double step_s, uint64_t *steps) {
    fmu_clock *clock = &instance->clock;
    const double own_s = fmu_model_own_step(&instance->model);
    fmu_status status = FMU_OK;
    if (step_s == clock->communication_s || is_remainder(instance, step_s)) {
        *steps = step_s == clock->communication_s ? clock->communication_ticks : 0;
        return FMU_OK;
    }
    if (own_s > 0.0) {
        if (clock->step_s != own_s) status = change_step(instance, own_s);
        if (status == FMU_OK) status = fmu_model_count_steps(instance, step_s, own_s, steps);
        if (status == FMU_OK) status = check_count_of_steps(instance, step_s, own_s, *steps);
    } else {
        const double off = step_s - clock->step_s;
        if (!(off <= SAME_STEP * step_s && off >= -SAME_STEP * step_s)) status = change_step(instance, step_s);
        *steps = 1;
    }
    if (status == FMU_OK) {
        clock->communication_s = step_s;
        clock->communication_ticks = *steps;
    }
    return status;
}

/* Takes one internal step at a time; the importer may get and set variables after each. */
static fmu_status run_with_updates(fmu_instance *instance, uint64_t steps, fmu_step_end *end) {
    uint64_t taken;
    for (uint64_t k = 0; k < steps; k++) {
        const fmu_status status = fmu_model_run(instance, 1, &taken);
        if (status != FMU_OK) return status;
        instance->clock.ticks++;
        instance->model.time_s = fmu_clock_now(&instance->clock);
        fmu_enter(instance, FMU_INTERMEDIATE);
        end->early = instance->between_steps(instance, k + 1 == steps) && k + 1 < steps;
        fmu_enter(instance, FMU_STEP);
        if (end->early || instance->cancelled) return FMU_OK;
    }
    return FMU_OK;
}

/* Another thread calls it while a communication step of several internal ones runs, which then ends soon. A flag is
 * enough: it changes once, and the step reads it again and again. */
fmu_status fmu_cancel_step(fmu_instance *instance) {
    if (!instance->running)
        return fmu_refuse(
            instance,
            "CancelStep is not allowed in %s: no step is running; another thread may call it while DoStep "
            "runs",
            fmu_mode_names[instance->mode]);
    instance->cancelled = true;
    return FMU_OK;
}

static fmu_status discard_cancelled(const fmu_instance *instance, uint64_t ticks) {
    return fmu_log(instance, FMU_DISCARD, FMU_LOG_DISCARD,
                   "the communication step is cancelled after %llu internal steps and taken back",
                   (unsigned long long)(instance->clock.ticks - ticks));
}

/* A refused or cancelled communication step leaves everything as it was before the call. */
static fmu_status run_several(fmu_instance *instance, uint64_t steps, fmu_step_end *end) {
    const uint64_t ticks = instance->clock.ticks;
    fmu_model_motion before;
    uint64_t taken = 0;
    fmu_status status;
    fmu_model_save_motion(&instance->model, &before);
    instance->cancelled = false;
    instance->running = true;
    if (instance->between_steps != NULL) {
        status = run_with_updates(instance, steps, end);
    } else {
        status = fmu_model_run(instance, steps, &taken);
        instance->clock.ticks += taken;
    }
    instance->running = false;
    if (status == FMU_OK && instance->cancelled) status = discard_cancelled(instance, ticks);
    if (status == FMU_OK) return status;
    fmu_model_restore_motion(&instance->model, &before);
    instance->clock.ticks = ticks;
    return status;
}

/* A single internal step that is refused has changed nothing, so nothing needs to be restored. */
static fmu_status run(fmu_instance *instance, uint64_t steps, fmu_step_end *end) {
    uint64_t taken = 0;
    if (steps != 1 || instance->between_steps != NULL) return run_several(instance, steps, end);
    const fmu_status status = fmu_model_run(instance, 1, &taken);
    instance->clock.ticks += taken;
    return status;
}

/* The usual case: one internal step, as long as the last one, from the model's time. */
static inline bool is_one_more(const fmu_instance *instance, double at_s, double step_s) {
    const fmu_clock *clock = &instance->clock;
    const double off_s = at_s - instance->model.time_s;
    return step_s == clock->communication_s && clock->communication_ticks == 1 && off_s <= OFF_WITHOUT_STEP * step_s &&
           off_s >= -OFF_WITHOUT_STEP * step_s && !clock->stop_defined && !instance->model.start_needed &&
           !instance->model.change_needed && instance->between_steps == NULL;
}

static inline fmu_status take_step(fmu_instance *instance, double at_s, double step_s, fmu_step_end *end) {
    uint64_t steps = 1;
    fmu_status status;
    end->early = false;
    if (is_one_more(instance, at_s, step_s)) {
        if (FMU_MODEL_KEEPS_STEPS) fmu_model_begin_step(&instance->model);
        status = fmu_model_run(instance, 1, &steps);
        instance->clock.ticks += steps;
        if (instance->warnings_pending != 0) fmu_model_settle_warnings(instance, status == FMU_OK);
        end->time_s = instance->model.time_s = fmu_clock_now(&instance->clock);
        return status;
    }
    status = check_interval(instance, at_s, step_s);
    if (status == FMU_OK) status = fmu_apply_parameters(instance);
    if (status == FMU_OK) status = count_steps(instance, step_s, &steps);
    if (FMU_MODEL_KEEPS_STEPS && status == FMU_OK) fmu_model_begin_step(&instance->model);
    if (status == FMU_OK) status = run(instance, steps, end);
    if (instance->warnings_pending != 0) fmu_model_settle_warnings(instance, status == FMU_OK);
    end->time_s = instance->model.time_s = fmu_clock_now(&instance->clock);
    return status;
}

fmu_status fmu_do_step(fmu_instance *instance, double at_s, double step_s, fmu_step_end *end) {
    if (!FMU_MODEL_KEEPS_STEPS) return take_step(instance, at_s, step_s, end);
    const fmu_status status = take_step(instance, at_s, step_s, end);
    fmu_model_end_step(&instance->model, status);
    return status;
}
