/* batch: what a step of a lane costs beside one of a vehicle alone, in CPU time of one core. Prints for each width of
 * registers nanoseconds and ratio: step by step (inputs are read anew), in one run of 100 steps, and in one run with
 * voltages sampled anew for each (beside steps of one vehicle). */
#include "laconic/batch.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define REAL(x) ((laconic_real)(x))
#define STEPS 100
#define ROUNDS 9

/* The Robotino 2 of scenes/robotino2.toml, by a mass of its own and with `damping` times its motors' damping. */
static laconic_vehicle robotino(double mass_kg, double damping) {
    static const double along[3] = {0.5, -1.0, 0.5}, across[3] = {0.8660254037844386, 0.0, -0.8660254037844386};
    static const double bearing_rad[3] = {1.0471975511965976, 3.141592653589793, 5.235987755982989};
    laconic_vehicle v = {.mass_kg = REAL(mass_kg), .yaw_inertia_kgm2 = REAL(0.0625), .wheel_radius_m = REAL(0.04)};
    v.wheel_inertia_kgm2 = REAL(0.004575);
    v.motor_gain_Nm_per_V = REAL(0.1382);
    v.motor_damping_Nms = REAL(0.1137 * damping);
    for (v.wheel_count = 0; v.wheel_count < 3; v.wheel_count++) {
        laconic_wheel *wheel = &v.wheel[v.wheel_count];
        wheel->kind = LACONIC_WHEEL_ROLLER;
        wheel->x_m = REAL(0.125 * along[v.wheel_count]);
        wheel->y_m = REAL(0.125 * across[v.wheel_count]);
        wheel->axle_rad = REAL(bearing_rad[v.wheel_count]);
        wheel->roller_rad = REAL(1.5707963267948966);
    }
    return v;
}

typedef enum way { STEP_BY_STEP, IN_ONE_RUN, SAMPLED } way;

static const char *const name_of[] = {"step by step", "in one run  ", "sampled     "};

typedef struct population {
    const char *name;
    int32_t lanes, kinds;
    laconic_batch_kind *kind;
    int32_t *kind_of;
    laconic_state *start, *now;
    laconic_input *input;
    laconic_real *voltage; /* [STEPS][3][lanes] */
} population;

static void *room(size_t bytes) {
    void *memory = calloc(1, bytes + 64);
    if (memory == NULL) exit(2);
    return (void *)(((uintptr_t)memory + 63) / 64 * 64); /* never given back: the program ends */
}

/* Steps of 1 ms; mixed: of every second kind the motors damp so fast that auto chooses the other method. */
static population population_of(const char *name, const laconic_method *method, int32_t lanes, int32_t kinds,
                                double other_damping) {
    population p = {.name = name, .lanes = lanes, .kinds = kinds};
    p.kind = (laconic_batch_kind *)room((size_t)kinds * sizeof *p.kind);
    p.kind_of = (int32_t *)room((size_t)lanes * sizeof *p.kind_of);
    p.start = (laconic_state *)room((size_t)lanes * sizeof *p.start);
    p.now = (laconic_state *)room((size_t)lanes * sizeof *p.now);
    p.input = (laconic_input *)room((size_t)lanes * sizeof *p.input);
    p.voltage = (laconic_real *)room((size_t)lanes * STEPS * 3 * sizeof *p.voltage);
    for (int32_t k = 0; k < kinds; k++) {
        const laconic_vehicle v = robotino(8.0 + k / (double)kinds, k % 2 ? other_damping : 1.0);
        if (laconic_batch_kind_of(&p.kind[k], &v, method, REAL(1e-3), NULL) != LACONIC_OK) exit(2);
    }
    for (int32_t i = 0; i < lanes; i++) {
        const laconic_start start = {.heading_rad = REAL(0.1 * i)};
        p.kind_of[i] = i % kinds;
        if (laconic_state_set(&p.start[i], &p.kind[p.kind_of[i]].model, &start, NULL) != LACONIC_OK) exit(2);
        for (int k = 0; k < 3; k++) p.input[i].voltage_V[k] = REAL(-5.3 + 5.3 * k + 0.01 * (i % 100));
        for (int k = 0; k < 3 * STEPS; k++) p.voltage[k * lanes + i] = p.input[i].voltage_V[k % 3];
    }
    return p;
}

static double seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }

static double one_by_one(const population *p, way w) {
    laconic_status status;
    for (int32_t i = 0; i < p->lanes; i++) p->now[i] = p->start[i];
    const double from = seconds();
    for (int s = 0; s < (w == IN_ONE_RUN ? 1 : STEPS); s++)
        for (int32_t i = 0; i < p->lanes; i++) {
            const laconic_batch_kind *kind = &p->kind[p->kind_of[i]];
            laconic_run(&kind->model, &kind->integrator, &p->now[i], &p->input[i], w == IN_ONE_RUN ? STEPS : 1,
                        &status);
        }
    return seconds() - from;
}

static double together(const population *p, laconic_batch *batch, way w) {
    for (int32_t i = 0; i < p->lanes; i++) laconic_batch_load(batch, i, &p->start[i]);
    const double from = seconds();
    if (w == SAMPLED) laconic_batch_run_sampled(batch, 0, batch->block_count, STEPS, 1, p->voltage);
    if (w == IN_ONE_RUN) laconic_batch_run(batch, 0, batch->block_count, STEPS);
    for (int s = 0; w == STEP_BY_STEP && s < STEPS; s++) laconic_batch_run(batch, 0, batch->block_count, 1);
    return seconds() - from;
}

/* Both in turn, so that both meet the same clock; the least of each. */
static void compare(const population *p, laconic_batch *batch, way w) {
    double alone = 1e9, many = 1e9;
    for (int round = 0; round < ROUNDS; round++) {
        const double a = one_by_one(p, w), b = together(p, batch, w);
        alone = a < alone ? a : alone;
        many = b < many ? b : many;
    }
    const double each = 1e9 / ((double)p->lanes * STEPS);
    printf("%-22s %2d bytes  %s %6.1f ns, alone %6.1f ns: %.2f\n", p->name, (int)batch->shape.width_bytes, name_of[w],
           many * each, alone * each, many / alone);
}

static void measure(const population p) {
    static const int32_t widths[] = {16, 32, 64};
    for (int w = 0; w < 3; w++) {
        const laconic_batch_shape shape = {p.lanes, p.kinds, 3, widths[w]};
        laconic_batch batch;
        if (laconic_batch_width(widths[w]) == 0) continue;
        if (!laconic_batch_place(&batch, room(laconic_batch_size(&shape)), &shape, p.kind, p.kind_of)) exit(2);
        for (int32_t i = 0; i < p.lanes; i++) laconic_batch_set_input(&batch, i, &p.input[i]);
        compare(&p, &batch, STEP_BY_STEP);
        compare(&p, &batch, IN_ONE_RUN);
        compare(&p, &batch, SAMPLED);
    }
}

int main(void) {
    printf("%s precision\n", LACONIC_REAL_NAME);
    const population mixed = population_of("auto, 10,000 mixed", &laconic_auto, 10000, 10000, 400.0);
    if (mixed.kind[0].integrator.chosen == mixed.kind[1].integrator.chosen) return 2; /* it would not be mixed */
    measure(population_of("explicit, one kind", &laconic_rk4, 1000, 1, 1.0));
    measure(population_of("explicit, each its own", &laconic_rk4, 1000, 1000, 1.0));
    measure(population_of("auto, one kind", &laconic_auto, 1000, 1, 1.0));
    measure(mixed);
    return 0;
}
