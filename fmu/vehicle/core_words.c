/* Refusals of the core and idle inputs in the log of an FMU; directions; how many internal steps a communication step
 * has. */
#include "core_words.h"

#include <stdio.h>

/* A larger quotient is no number of steps: laconic_steps_in refuses it. */
#define MOST_STEPS 9e15

/* laconic_message names a field as a scene does; the log of an FMU names the variable. */
static void explain(char *text, size_t size, const laconic_refusal *why) {
    char reason[256];
    const char *name = laconic_field_name(why->field);
    laconic_explanation(why, reason, sizeof reason);
    if (why->item > 0)
        (void)snprintf(text, size, "%s[%d]: %s", name, (int)why->item, reason);
    else
        (void)snprintf(text, size, "%s%s%s", name, *name != '\0' ? ": " : "", reason);
}

fmu_status fmu_refuse_with(const fmu_instance *instance, const laconic_refusal *why, const char *when) {
    char text[320];
    explain(text, sizeof text, why);
    return fmu_refuse(instance, "%s: %s", when, text);
}

fmu_status fmu_discard_with(const fmu_instance *instance, const laconic_refusal *why) {
    char text[320];
    explain(text, sizeof text, why);
    return fmu_log(instance, FMU_DISCARD, FMU_LOG_DISCARD, "the step at %.15g s is refused: %s",
                   fmu_clock_now(&instance->clock), text);
}

void fmu_warn_idle(fmu_instance *instance, const fmu_idle_input *idle, unsigned kind, int32_t element, double value) {
    if (value == 0.0 || instance->warnings_given >> kind & 1U) return;
    instance->warnings_given |= 1U << kind;
    (void)fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING, "%s[%d]: %.9g %s has no effect: %s; give 0 (logged once)",
                  idle->name, (int)(element + 1), value, idle->unit, idle->needs);
}

void fmu_turn(double turned[2], const laconic_heading *heading, double x, double y) {
    laconic_model model = {0};
    laconic_state state = {0};
    laconic_pose pose;
    model.com_x_m = -x;
    model.com_y_m = -y;
    state.heading = *heading;
    laconic_pose_of(&pose, &model, &state);
    turned[0] = pose.origin_x_m;
    turned[1] = pose.origin_y_m;
}

/* The whole number of internal steps nearest to step_s that does not pass the stop time, in seconds; 0: there is
 * none. */
static double nearest_step(const fmu_instance *instance, double step_s, double own_s) {
    const double ratio = step_s / own_s;
    if (!(ratio < MOST_STEPS)) return 0.0;
    const uint64_t rounded = ratio < 1.0 ? 1 : (uint64_t)(ratio + 0.5);
    const double end_s = instance->model.time_s + own_s * (double)rounded;
    /* step_s itself does not pass the stop time, so one step less does not */
    return own_s * (double)(fmu_clock_passes_stop(&instance->clock, end_s, own_s) ? rounded - 1 : rounded);
}

fmu_status fmu_model_count_steps(fmu_instance *instance, double step_s, double own_s, uint64_t *steps) {
    laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    if (laconic_steps_in(step_s, own_s, steps, &why) == LACONIC_OK) return FMU_OK;
    const double nearest = nearest_step(instance, step_s, own_s);
    const int digits = fmu_digits(step_s, nearest, nearest);
    if (nearest > 0.0)
        return fmu_refuse(instance,
                          "the communication step of %.*g s is no whole number of internal steps of %.15g s "
                          "(step_s); nearest that is: %.*g s",
                          digits, step_s, own_s, digits, nearest);
    return fmu_refuse(instance,
                      "the communication step of %.15g s cannot be taken in internal steps of %.15g s (step_s): "
                      "set another step_s before the run",
                      step_s, own_s);
}
