/* One call of the friction solver for host_tests/references/friction: plain arrays in, plain arrays out.
 *
 * `data` holds one row of FRICTION_PROBE_NUMBERS numbers a wheel: along, across (3 each), rim_along, rim_across,
 * inertia, drag, grip, axle, drive, drive_slope, drive_limit, viscous, free_speed. Infinite numbers stand for
 * LACONIC_REAL_MAX. Returns the passes, or 0 if the solver refuses. */
#include "friction_solver.h"

#define FRICTION_PROBE_NUMBERS 17

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

EXPORT int32_t friction_probe(int32_t count, const laconic_real data[], const laconic_real free_nu[3],
                              laconic_real nu[3], laconic_real speed[], laconic_real impulse[][2]);

static laconic_real bounded(laconic_real x) { return x < LACONIC_REAL_MAX ? x : LACONIC_REAL_MAX; }

int32_t friction_probe(int32_t count, const laconic_real data[], const laconic_real free_nu[3], laconic_real nu[3],
                       laconic_real speed[], laconic_real impulse[][2]) {
    friction_wheel wheels[LACONIC_MAX_WHEELS] = {{.inertia = 0}};
    friction_load loads[LACONIC_MAX_WHEELS] = {{0}};
    for (int32_t i = 0; i < count && i < LACONIC_MAX_WHEELS; i++) {
        const laconic_real *d = data + i * FRICTION_PROBE_NUMBERS;
        for (int c = 0; c < 3; c++) {
            wheels[i].along[c] = d[c];
            wheels[i].across[c] = d[3 + c];
        }
        wheels[i].rim_along = d[6];
        wheels[i].rim_across = d[7];
        wheels[i].inertia = d[8];
        wheels[i].drag = d[9];
        loads[i] = (friction_load){.grip = bounded(d[10]),
                                   .axle = d[11],
                                   .drive = d[12],
                                   .drive_slope = d[13],
                                   .drive_limit = bounded(d[14]),
                                   .viscous = d[15],
                                   .free_speed = d[16]};
        laconic_friction_prepare(&wheels[i]);
    }
    return laconic_friction_solve(wheels, loads, count, free_nu, nu, speed, impulse);
}
