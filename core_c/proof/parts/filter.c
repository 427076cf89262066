/* Calls of the functions of filter.h, for Frama-C's analyser: any numbers, for each set of errors that
 * laconic_filter_start() may choose by itself, since the places of numbers follow from their counts. */
#include "laconic/filter.h"

#include "anything.h"

static laconic_filter filter;
static laconic_filter_settings settings;
static laconic_innovation innovation;

static void any_filter(int32_t dof, bool travels, int32_t biases) {
    any_model(&model);
    model.dof = dof;
    ANYTHING(filter);
    filter.state.heading.turns = Frama_C_long_long_interval(-MOST_TURNS - 1, MOST_TURNS);
    filter.dof = dof;
    filter.travels = travels ? dof : 0;
    filter.biases = biases;
    filter.errors = filter.travels + 3 + biases + dof;
}

static laconic_innovation *any_innovation(void) { return ANY_BOOL() ? &innovation : NULL; }

/* One call for each set of errors. */
#define FOR_EACH_SET(of) \
    do { \
        of(1, false, 0); \
        of(1, false, 1); \
        of(1, true, 0); \
        of(1, true, 1); \
        of(2, false, 0); \
        of(2, false, 1); \
        of(2, true, 0); \
        of(2, true, 1); \
        of(3, false, 0); \
        of(3, false, 1); \
        of(3, true, 0); \
        of(3, true, 1); \
    } while (0)

void prove_filter_start(void) {
    any_model(&model);
    any_state();
    ANYTHING(settings);
    (void)laconic_filter_start(&filter, &model, &settings, &state);
}

static void take_readings(int32_t dof, bool travels, int32_t biases) {
    static laconic_pose_fix fix;
    any_filter(dof, travels, biases);
    ANYTHING(of_wheels);
    ANYTHING(fix);
    PERHAPS(void) laconic_filter_encoders(&filter, &model, of_wheels, any_innovation());
    any_filter(dof, travels, biases);
    PERHAPS(void) laconic_filter_yaw_rate(&filter, &model, of_wheels[0], any_innovation());
    any_filter(dof, travels, biases);
    PERHAPS(void) laconic_filter_fix(&filter, &model, &fix, any_innovation());
}

void prove_filter_readings(void) { FOR_EACH_SET(take_readings); }

static void covariance(int32_t dof, bool travels, int32_t biases) {
    static laconic_real matrix[LACONIC_FILTER_OUTPUTS * LACONIC_FILTER_OUTPUTS];
    any_filter(dof, travels, biases);
    laconic_filter_covariance(matrix, &filter, &model);
}

void prove_filter_covariance(void) { FOR_EACH_SET(covariance); }

void prove_filter_turned(void) {
    static laconic_sensor_settings sensors;
    static int32_t before[LACONIC_MAX_WHEELS], now[LACONIC_MAX_WHEELS];
    ANYTHING(sensors);
    ANYTHING(before);
    ANYTHING(now);
    laconic_filter_turned(of_wheels, &sensors, before, now, Frama_C_interval(0, LACONIC_MAX_WHEELS));
}
