/* Time as an integer count of equal steps since the last change of the step: no drift, however long it runs. */
#ifndef LACONIC_FMU_CLOCK_H
#define LACONIC_FMU_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

typedef struct fmu_clock {
    double start_s, stop_s;
    bool stop_defined;
    double anchor_s, anchor_rest_s; /* the time of the last change of the step: the sum of both */
    double step_s;                  /* 0: no step taken yet                                        */
    uint64_t ticks;                 /* since the anchor                                            */
    double communication_s;         /* the last communication step of a whole number … */
    uint64_t communication_ticks;   /* … of this many internal steps */
    double completed_s;             /* Model Exchange: where the last completed step ended         */
} fmu_clock;

void fmu_clock_start(fmu_clock *clock, double start_s, bool stop_defined, double stop_s);
double fmu_clock_now(const fmu_clock *clock);

/* Whether a step of that size (0: none) that ends at that time passes the stop time. Importers add up their times, so a
 * time that lies beyond the stop time only by rounding, or by a millionth of the step, counts as the stop time. */
bool fmu_clock_passes_stop(const fmu_clock *clock, double time_s, double step_s);

/* Whether that time lies before the run began, by more than rounding. */
bool fmu_clock_is_before_start(const fmu_clock *clock, double time_s);

/* Whether a solver may evaluate the model at that time beyond the stop time: solvers that choose their steps (CVODE)
 * do so and interpolate back. Allowed up to a fiftieth of the run, after the first completed step and until the stop
 * time. */
bool fmu_clock_allows_overshoot(const fmu_clock *clock, double time_s);

/* From the present time on, steps have another size. */
void fmu_clock_change_step(fmu_clock *clock, double step_s);

#endif
