/* The time of an instance: ticks of a step since an anchor, and whether a time lies within the run. */
#include "clock.h"

void fmu_clock_start(fmu_clock *clock, double start_s, bool stop_defined, double stop_s) {
    const fmu_clock fresh = {0};
    *clock = fresh;
    clock->start_s = clock->anchor_s = clock->completed_s = start_s;
    clock->stop_defined = stop_defined;
    clock->stop_s = stop_s;
}

double fmu_clock_now(const fmu_clock *clock) {
    return clock->anchor_s + (clock->anchor_rest_s + (double)clock->ticks * clock->step_s);
}

static double magnitude(double value) { return value < 0.0 ? -value : value; }

bool fmu_clock_passes_stop(const fmu_clock *clock, double time_s, double step_s) {
    const double start_s = magnitude(clock->start_s), stop_s = magnitude(clock->stop_s);
    const double rounding_s = 1e-9 * (start_s > stop_s ? start_s : stop_s) + 1e-6 * step_s;
    return clock->stop_defined && time_s > clock->stop_s + rounding_s;
}

bool fmu_clock_is_before_start(const fmu_clock *clock, double time_s) {
    return time_s < clock->start_s - 1e-9 * magnitude(clock->start_s);
}

bool fmu_clock_allows_overshoot(const fmu_clock *clock, double time_s) {
    const double run_s = clock->stop_s - clock->start_s;
    const bool on_its_way = clock->completed_s > clock->start_s && clock->completed_s < clock->stop_s - 1e-9 * run_s;
    return on_its_way && time_s - clock->stop_s <= 0.02 * run_s;
}

/* The anchor is a compensated sum, since it moves at every step of a run with variable steps. */
void fmu_clock_change_step(fmu_clock *clock, double step_s) {
    const double passed = clock->anchor_rest_s + (double)clock->ticks * clock->step_s;
    const double anchor = clock->anchor_s + passed;
    const double back = anchor - clock->anchor_s;
    clock->anchor_rest_s = (clock->anchor_s - (anchor - back)) + (passed - back);
    clock->anchor_s = anchor;
    clock->ticks = 0;
    clock->step_s = step_s;
}
