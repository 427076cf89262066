#include "clock.h"

void fmu_clock_start(fmu_clock *clock, double start_s, bool stop_defined, double stop_s) {
    const fmu_clock fresh = {0};
    *clock = fresh;
    clock->start_s = clock->anchor_s = start_s;
    clock->stop_defined = stop_defined;
    clock->stop_s = stop_s;
}

double fmu_clock_now(const fmu_clock *clock) {
    return clock->anchor_s + (clock->anchor_rest_s + (double)clock->ticks * clock->step_s);
}

/* Compensated, since a run with variable steps moves the anchor at every one of them. */
void fmu_clock_change_step(fmu_clock *clock, double step_s) {
    const double passed = clock->anchor_rest_s + (double)clock->ticks * clock->step_s;
    const double anchor = clock->anchor_s + passed;
    const double back = anchor - clock->anchor_s;
    clock->anchor_rest_s = (clock->anchor_s - (anchor - back)) + (passed - back);
    clock->anchor_s = anchor;
    clock->ticks = 0;
    clock->step_s = step_s;
    clock->asked_s = 0.0;
}
