/* Communication steps of FMUs with bus terminals: of any length, also 0, since importers place them at the instants
 * that clocks ask for. */
#include <float.h>

#include "model_interface.h"

#define OFF_BY 1e-9 /* s: importers add up their times */

#define LATEST_S 4e9  /* 127 years: until then a double tells microseconds apart, which nodes count */
#define LONGEST_S 1e6 /* of one step, which takes each period of the node */

static double magnitude(double value) { return value < 0.0 ? -value : value; }

bool network_may_start(const fmu_instance *instance) {
    if (magnitude(instance->clock.start_s) <= LATEST_S) return true;
    fmu_refuse(instance, "the start time %.15g s cannot be taken: give one from %g s to %g s", instance->clock.start_s,
               -LATEST_S, LATEST_S);
    return false;
}

static fmu_status check_times(const fmu_instance *instance, double at_s, double step_s) {
    const double now_s = instance->model.time_s, off_s = magnitude(at_s - now_s);
    /* a sum of a million times is wrong by so much at most */
    const double most_s = OFF_BY + 1e6 * DBL_EPSILON * magnitude(at_s);
    if (!fmu_is_finite(at_s) || !fmu_is_finite(step_s))
        return fmu_refuse(instance, "a step of %g s from %g s cannot be taken: they must be finite", step_s, at_s);
    if (!(step_s >= 0.0))
        return fmu_refuse(instance, "a communication step of %.15g s cannot be taken: it must not be negative", step_s);
    if (!(step_s <= LONGEST_S && at_s + step_s <= LATEST_S))
        return fmu_refuse(instance,
                          "a communication step of %.15g s from %.15g s cannot be taken: give %g s or less, and an "
                          "end of %g s or less",
                          step_s, at_s, LONGEST_S, LATEST_S);
    if (!(off_s <= most_s)) return fmu_refuse_start(instance, at_s, now_s);
    if (fmu_clock_passes_stop(&instance->clock, at_s + step_s, step_s))
        return fmu_refuse_end(instance, at_s, at_s + step_s);
    return FMU_OK;
}

fmu_status fmu_do_step(fmu_instance *instance, double at_s, double step_s, fmu_step_end *end) {
    fmu_model *model = &instance->model;
    fmu_status status = check_times(instance, at_s, step_s);
    end->early = false;
    if (status == FMU_OK) status = fmu_apply_parameters(instance);
    if (status == FMU_OK) {
        fmu_model_advance(instance, at_s + step_s);
        model->time_s = at_s + step_s;
        model->stale = FMU_GROUPS_ALL;
        network_ports_make_due(model->port, FMU_MODEL_PORTS);
    }
    end->time_s = model->time_s;
    return status;
}

void fmu_model_end_event(fmu_instance *instance) {
    fmu_model_receive(instance);
    network_ports_settle(instance->model.port, FMU_MODEL_PORTS);
    instance->model.stale = FMU_GROUPS_ALL;
}

bool fmu_model_needs_update(const fmu_model *model) { return network_ports_need_update(model->port, FMU_MODEL_PORTS); }

bool fmu_model_needs_event(const fmu_model *model) { return network_ports_are_due(model->port, FMU_MODEL_PORTS); }

/* ---------------------------------------------------------------- what these models do not have -- */

static fmu_status refuse_exchange(const fmu_instance *instance) {
    return fmu_refuse(instance, "this FMU offers no Model Exchange and no derivatives");
}

fmu_status fmu_set_time(fmu_instance *instance, double time_s) {
    (void)time_s;
    return refuse_exchange(instance);
}

fmu_status fmu_completed_step(fmu_instance *instance) { return refuse_exchange(instance); }

#define ABSENT_STATES(name, values_type) \
    fmu_status name(fmu_instance *instance, values_type *values, size_t count) { \
        (void)values; \
        return fmu_refuse_kind(instance, "continuous state", count); \
    }
ABSENT_STATES(fmu_get_states, double)
ABSENT_STATES(fmu_set_states, const double)
ABSENT_STATES(fmu_get_rates, double)
ABSENT_STATES(fmu_get_nominals, double)

uint32_t fmu_model_state_count(const fmu_model *model) {
    (void)model;
    return 0;
}

/* No variable is a continuous state. */
void fmu_model_before_set_state(fmu_instance *instance) { (void)instance; }

#define ABSENT_DERIVATIVES(name) \
    fmu_status name(fmu_instance *instance, fmu_references unknowns, fmu_references knowns, const double *seed, \
                    size_t seed_count, double *sensitivity, size_t sensitivity_count) { \
        (void)unknowns; \
        (void)knowns; \
        (void)seed; \
        (void)seed_count; \
        (void)sensitivity; \
        (void)sensitivity_count; \
        return refuse_exchange(instance); \
    }
ABSENT_DERIVATIVES(fmu_directional)
ABSENT_DERIVATIVES(fmu_adjoint)

fmu_status fmu_output_derivatives(fmu_instance *instance, fmu_references outputs, const int32_t *orders, double *values,
                                  size_t value_count) {
    (void)outputs;
    (void)orders;
    (void)values;
    (void)value_count;
    return refuse_exchange(instance);
}
