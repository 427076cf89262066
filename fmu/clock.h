/* Time as an integer count of equal steps since the last change of the step: no drift, however long it runs. */
#ifndef LACONIC_FMU_CLOCK_H
#define LACONIC_FMU_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

typedef struct fmu_clock {
    double start_s, stop_s;
    bool stop_defined;
    double anchor_s, anchor_rest_s; /* when the step changed last: the sum of both                 */
    double step_s;                  /* 0: no step taken yet                                        */
    uint64_t ticks;                 /* since the anchor                                            */
    double communication_s;         /* the last communication step that was found to fit …         */
    uint64_t communication_ticks;   /* … and the internal steps in it                              */
    double completed_s;             /* Model Exchange: where the last completed step ended         */
} fmu_clock;

void fmu_clock_start(fmu_clock *clock, double start_s, bool stop_defined, double stop_s);
double fmu_clock_now(const fmu_clock *clock);

/* Whether a step of that size (0: none) must not end at that time. Importers add up their times, so what lies behind the
 * stop time by rounding, or by a millionth of the step, is the stop time. */
bool fmu_clock_passes_stop(const fmu_clock *clock, double time_s, double step_s);

/* Whether that time lies before the run began, by more than rounding. */
bool fmu_clock_is_before_start(const fmu_clock *clock, double time_s);

/* Whether a solver that steps towards the stop time may look at that time behind it: solvers with a step of their own
 * (CVODE) do so and interpolate back. No further than a fiftieth of the run, and not before it has completed a step. */
bool fmu_clock_allows_overshoot(const fmu_clock *clock, double time_s);

/* From here on steps of another size. */
void fmu_clock_change_step(fmu_clock *clock, double step_s);

#endif
