/* count_record KIND EVERY WATCH STEPS: a mecanum carriage along a schedule, so that instructions can be counted. KIND
 * held or sampled; EVERY: steps between two rows of its usual outputs, 0: none; WATCH: 0 nothing of the ground, 1 the
 * no-slip margin in the rows, 2 watched at every step. The difference of two counts is the cost of a step or a row. */
#include "vehicles.h"

#include <stdio.h>
#include <stdlib.h>

#define MOST_STEPS 8192

static const uint32_t column[] = {offsetof(laconic_outputs, nu_rad_per_s),
                                  offsetof(laconic_outputs, nu_rad_per_s) + sizeof(laconic_real),
                                  offsetof(laconic_outputs, pose.x_m),
                                  offsetof(laconic_outputs, pose.y_m),
                                  offsetof(laconic_outputs, pose.heading_rad),
                                  offsetof(laconic_outputs, velocity_body_m_per_s),
                                  offsetof(laconic_outputs, yaw_rate_rad_per_s),
                                  offsetof(laconic_outputs, wheel_speed_rad_per_s),
                                  offsetof(laconic_outputs, wheel_angle_rad),
                                  offsetof(laconic_outputs, energy_J),
                                  offsetof(laconic_outputs, reactions.no_slip_margin_N)};
#define COLUMNS ((int32_t)(sizeof column / sizeof column[0]))

static const uint32_t signal[] = {offsetof(laconic_input, voltage_V),
                                  offsetof(laconic_input, voltage_V) + sizeof(laconic_real)};
static laconic_real row[MOST_STEPS * sizeof column / sizeof column[0]];
static laconic_real value[MOST_STEPS * 3 * 2];

int main(int argc, char **argv) {
    const laconic_vehicle vehicle = with_motors(mecanum());
    const laconic_start start = start_with(1, 2, 3);
    const bool sampled = argc == 5 && strcmp(argv[1], "sampled") == 0;
    const uint64_t every = argc == 5 ? strtoul(argv[2], NULL, 10) : 1,
                   steps = argc == 5 ? strtoul(argv[4], NULL, 10) : 10;
    const int watch = argc == 5 ? atoi(argv[3]) : 2;
    const uint64_t for_ever = UINT64_MAX;
    const laconic_schedule schedule = {2, signal, value, sampled ? NULL : &for_ever, sampled ? MOST_STEPS : 1, 0};
    laconic_grip grip = {0};
    laconic_contact contact;
    laconic_plant plant;
    laconic_recorder recorder = {NULL, NULL, every, COLUMNS - 1, column, row, 0, MOST_STEPS, NULL};
    if (steps > MOST_STEPS) return 2;
    for (size_t k = 0; k < sizeof value / sizeof value[0]; k++) value[k] = REAL(0.001) * (laconic_real)(k % 100);
    if (laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.01), &start, NULL) != LACONIC_OK) return 1;
    if (laconic_contact_prepare(&contact, &vehicle, NULL) != LACONIC_OK) return 1;
    if (watch > 0) {
        recorder.contact = &contact;
        recorder.column_count = COLUMNS;
    }
    if (watch > 1) recorder.grip = &grip;
    if (laconic_plant_follow(&plant, &schedule, steps, &recorder, NULL) != LACONIC_OK) return 1;
    printf("%llu steps, %llu rows, %llu looks\n", (unsigned long long)plant.steps,
           (unsigned long long)recorder.row_count, (unsigned long long)grip.instants);
    return plant.steps != steps;
}
