/* A filter that follows recorded readings, cycle by cycle: the same code runs on the host and is counted on a Cortex-M.
 * Model, integrator and start are generated constants (`laconic trim`), and so are the readings. */
#ifndef BENCH_FILTER_H
#define BENCH_FILTER_H

#include "bench.h"
#include "laconic/filter.h"

typedef struct bench_reading { /* of one cycle */
    laconic_real voltage_V[LACONIC_MAX_WHEELS], turned_rad[LACONIC_MAX_WHEELS];
    laconic_real yaw_rate_rad_per_s;
} bench_reading;

extern const bench_reading bench_readings[];
extern const uint32_t bench_reading_count;
extern const laconic_filter_settings bench_filter_settings;

laconic_status bench_filter_start(void);

/* The parts of a cycle, in their order. */
#define BENCH_PARTS 3
extern const char *const bench_part_names[BENCH_PARTS];
laconic_status bench_part(uint32_t part, uint32_t cycle);

/* Every bit of the estimate and its covariance. */
void bench_write_filter(write_bits write);

#endif
