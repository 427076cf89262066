/* Steps of prepared vehicles from any motion: what a step promises holds, whatever acts.
 *
 *     finite      what is accepted is finite, what is refused leaves the motion as it was
 *     same bits   n steps at once are n single steps of another plant to which the motion was copied (save and restore)
 *     energy      where nothing drives it does not grow
 *     tangent     is refused where the step is, its adjoint is its transpose, and it is what differences show
 *
 * Input: vehicle, method, step; the motion; then up to three pieces of one or two steps with what acts over them. */
#include "fuzz_motions.h"
#include "laconic/derivatives.h"

enum { VEHICLES = 11, SIZES = 4, PIECES = 3, STATE = 6, PARTS = STATE + LACONIC_MAX_WHEELS };

#define HALF_TURN 3.14159265358979323846
/* A step may gain so much of the energy by the check of docs/integrators.md (2⁻¹⁰ on either side), with friction only
 * by rounding. */
#define GAIN_OF_A_STEP 2e-3
#define GAIN_BY_FRICTION 1e-9
#define SMALL 1e-5 /* of the differences */

/* ------------------------------------------------------------------------------- vehicles -- */

static void add(laconic_vehicle *v, laconic_wheel_kind kind, double x_m, double y_m, double axle_rad,
                double roller_rad) {
    laconic_wheel *wheel = &v->wheel[v->wheel_count++];
    wheel->kind = kind;
    wheel->x_m = x_m;
    wheel->y_m = y_m;
    wheel->axle_rad = axle_rad;
    wheel->roller_rad = roller_rad;
}

static void add_mecanum(laconic_vehicle *v) {
    for (int k = 0; k < 4; k++)
        add(v, LACONIC_WHEEL_ROLLER, k < 2 ? 0.2 : -0.2, k % 2 ? -0.15 : 0.15, -HALF_TURN / 2,
            k == 0 || k == 3 ? HALF_TURN / 4 : -HALF_TURN / 4);
}

static void add_omni(laconic_vehicle *v) {
    add(v, LACONIC_WHEEL_ROLLER, 0.05, 0, 0, HALF_TURN / 2);
    add(v, LACONIC_WHEEL_ROLLER, -0.05, 0, HALF_TURN, HALF_TURN / 2);
    add(v, LACONIC_WHEEL_ROLLER, 0, 0.06, HALF_TURN / 2, HALF_TURN / 2);
}

static void add_pair(laconic_vehicle *v) {
    add(v, LACONIC_WHEEL_FIXED, 0.075, 0, 0, 0);
    add(v, LACONIC_WHEEL_FIXED, -0.075, 0, HALF_TURN, 0);
}

static void give_friction(laconic_vehicle *v) {
    v->ground.friction_coefficient = 0.6;
    v->ground.roller_drag = 0.2;
    v->ground.axle_friction_Nm = 0.01;
    v->drive.supply_V = 12;
    v->drive.supply_resistance_ohm = 0.1;
    v->drive.current_limit_A = 5;
    v->drive.winding_resistance_ohm = 0.5;
    v->com_z_m = 0.1;
}

static void add_wheels(laconic_vehicle *v, int number) {
    switch (number) {
    case 0: break;
    case 1:
    case 2:
    case 8: add_mecanum(v); break;
    case 3: add(v, LACONIC_WHEEL_FIXED, 0, 0, -HALF_TURN / 2, 0); break;
    case 4:
    case 9: add_pair(v); break;
    default: add_omni(v);
    }
}

static laconic_vehicle vehicle_of(int number) {
    laconic_vehicle v;
    memset(&v, 0, sizeof v);
    v.mass_kg = 10;
    v.yaw_inertia_kgm2 = 0.225;
    v.com_y_m = number > 3 ? 0.02 : 0;
    v.wheel_radius_m = 0.05;
    v.wheel_inertia_kgm2 = 0.009;
    v.motor_gain_Nm_per_V = 0.5;
    v.motor_damping_Nms = number == 6 ? 2 : number == 7 ? 0 : 0.02;
    add_wheels(&v, number);
    if (number == 2) {
        v.wheel[1].own_radius_m = 0.06;
        v.wheel[2].own_inertia_kgm2 = 0.02;
        v.wheel[3].own_motor_damping_Nms = 0.05;
        v.ground.slope_rad = 0.2;
        v.payload.mass_kg = 2;
        v.payload.x_m = 0.1;
    }
    if (number == 5) v.wheel[2].locked = true;
    if (number >= 8) give_friction(&v);
    if (number == 9) { /* two wheels fall over without something in front and behind */
        v.support_count = 2;
        v.support[0].y_m = 0.1;
        v.support[1].y_m = -0.1;
    }
    return v;
}

/* Each vehicle by each method with each step, prepared once; those that are refused have no step. */
static laconic_plant prepared[VEHICLES][LACONIC_METHOD_COUNT][SIZES];

static void prepare_all(void) {
    static const laconic_real sizes_s[SIZES] = {0.001, 0.01, 0.05, 1};
    const laconic_start still = {0};
    int count = 0;
    for (int v = 0; v < VEHICLES; v++)
        for (int m = 0; m < LACONIC_METHOD_COUNT; m++)
            for (int s = 0; s < SIZES; s++) {
                const laconic_vehicle vehicle = vehicle_of(v);
                count += laconic_plant_start(&prepared[v][m][s], &vehicle, laconic_method_by_number(m), sizes_s[s],
                                             &still, NULL) == LACONIC_OK;
            }
    must(count > VEHICLES * LACONIC_METHOD_COUNT); /* else the table is no good */
}

/* ---------------------------------------------------------------------------------- energy -- */

static bool nothing_drives(const laconic_plant *plant, const laconic_input *input) {
    static const laconic_input none;
    return memcmp(input, &none, sizeof none) == 0 && !plant->model.sloped;
}

static void check_energy(const laconic_plant *plant, laconic_real before_J, uint64_t steps) {
    const laconic_real gain = plant->friction.acts ? GAIN_BY_FRICTION : GAIN_OF_A_STEP;
    laconic_real most_J = before_J;
    for (uint64_t k = 0; k < steps; k++) most_J *= 1 + gain;
    must(laconic_plant_energy_J(plant) <= most_J + 1e-290);
}

/* --------------------------------------------------------------------------------- tangent -- */

static void motion_of(const laconic_plant *plant, laconic_start *motion) {
    memset(motion, 0, sizeof *motion);
    laconic_nu(&plant->model, &plant->state, motion->nu_rad_per_s);
    laconic_position(&plant->state, &motion->x_m, &motion->y_m, &motion->heading_rad);
}

static laconic_real size_of(laconic_real x) { return x < 0 ? -x : x; }

/* Where a difference has digits: usual numbers. */
static bool is_usual(const laconic_start *motion, const laconic_input *held, int32_t wheels) {
    bool is = size_of(motion->x_m) < 10 && size_of(motion->y_m) < 10 && size_of(motion->heading_rad) < 10;
    for (int k = 0; k < 3; k++) is = is && size_of(motion->nu_rad_per_s[k]) < 30;
    for (int32_t i = 0; i < wheels; i++) is = is && size_of(held->voltage_V[i]) < 30;
    is = is && size_of(held->axle_torque_Nm[0]) < 10 && size_of(held->body_force_N[0]) < 30;
    is = is && size_of(held->body_moment_Nm) < 10 && size_of(held->world_force_N[1]) < 30;
    return is && size_of(held->world_force_point_m[0]) < 2;
}

/* In long steps, in which an input turns the vehicle far, the rounds of a collocation end before their solution;
 * from rest they may settle where those beside it diverge, and differences show nothing (laconic/derivatives.h). */
static bool ends_before_its_solution(const laconic_plant *plant) {
    return strcmp(plant->integrator.chosen->name, laconic_exponential_gauss_8.name) == 0 &&
           plant->integrator.step_s > 0.1;
}

/* ν, x, y, θ, χ after a step from a motion moved along a direction; false where there is none. */
static bool step_from(laconic_real *end, const laconic_plant *plant, const laconic_start *motion,
                      const laconic_input *held, const laconic_state_change *along, const laconic_input *and_along,
                      laconic_real by) {
    laconic_state state;
    laconic_start moved = *motion;
    laconic_input input = *held;
    for (int k = 0; k < 3; k++) moved.nu_rad_per_s[k] += by * along->nu_rad_per_s[k];
    moved.heading_rad += by * along->heading_rad;
    input.voltage_V[0] += by * and_along->voltage_V[0];
    input.body_moment_Nm += by * and_along->body_moment_Nm;
    if (laconic_state_project(&state, &plant->model, &moved, NULL) != LACONIC_OK) return false;
    if (laconic_step(&plant->model, &plant->integrator, &state, &input) != LACONIC_OK) return false;
    laconic_nu(&plant->model, &state, end);
    laconic_position(&state, &end[3], &end[4], &end[5]);
    laconic_wheel_angles(&plant->model, &state, end + STATE);
    return true;
}

static int rows_of(laconic_real *row, const laconic_state_change *change, int32_t wheels) {
    memcpy(row, change->nu_rad_per_s, sizeof change->nu_rad_per_s);
    row[3] = change->x_m;
    row[4] = change->y_m;
    row[5] = change->heading_rad;
    memcpy(row + STATE, change->wheel_angle_rad, (size_t)wheels * sizeof *row);
    return STATE + wheels;
}

/* Differences over two lengths, whose own difference tells how much they are worth: a step that jumps between branches
 * has none. */
static void check_differences(const laconic_plant *plant, const laconic_start *motion, const laconic_input *held,
                              const laconic_state_change *along, const laconic_input *and_along,
                              const laconic_real *tangent, int count) {
    laconic_real end[4][PARTS], size = 1;
    static const laconic_real by[4] = {SMALL, -SMALL, 2 * SMALL, -2 * SMALL};
    for (int k = 0; k < 4; k++)
        if (!step_from(end[k], plant, motion, held, along, and_along, by[k])) return;
    for (int k = 0; k < count; k++) size += size_of(tangent[k]);
    for (int k = 0; k < count; k++) {
        const laconic_real near = (end[0][k] - end[1][k]) / (2 * SMALL), far = (end[2][k] - end[3][k]) / (4 * SMALL);
        must(size_of(near - tangent[k]) <= 1e-6 * size + 10 * size_of(near - far));
    }
}

/* ⟨adjoint, direction⟩ = ⟨covector, tangent⟩. */
static void check_adjoint(const laconic_plant *plant, const laconic_input *held, const laconic_state_change *along,
                          const laconic_input *and_along, const laconic_real *tangent, int count, reader *from) {
    laconic_state_change covector, gradient;
    laconic_input by_input;
    laconic_real of[PARTS], with[PARTS], to[PARTS], sum = 0, size = 0;
    memset(&covector, 0, sizeof covector);
    memset(&gradient, 0, sizeof gradient);
    memset(&by_input, 0, sizeof by_input);
    for (int k = 0; k < 3; k++) covector.nu_rad_per_s[k] = (laconic_real)(byte(from) - 128) / 64;
    covector.x_m = (laconic_real)(byte(from) - 128) / 64;
    covector.heading_rad = 1;
    covector.wheel_angle_rad[0] = plant->model.wheel_count > 0 ? 1 : 0;
    must(laconic_step_adjoint(&gradient, &by_input, NULL, &plant->model, &plant->integrator, &plant->state, held,
                              &covector) == LACONIC_OK);
    rows_of(of, &covector, count - STATE);
    rows_of(with, &gradient, count - STATE);
    rows_of(to, along, count - STATE);
    for (int k = 0; k < count; k++) {
        sum += of[k] * tangent[k] - with[k] * to[k];
        size += size_of(of[k] * tangent[k]) + size_of(with[k] * to[k]);
    }
    sum -= by_input.voltage_V[0] * and_along->voltage_V[0] + by_input.body_moment_Nm * and_along->body_moment_Nm;
    size += size_of(by_input.voltage_V[0] * and_along->voltage_V[0]) +
            size_of(by_input.body_moment_Nm * and_along->body_moment_Nm);
    must(size_of(sum) <= 1e-9 * (size + 1));
}

/* From the motion as it is now, along a direction of the bytes. */
static void check_tangent(const laconic_plant *plant, const laconic_input *held, reader *from) {
    laconic_state_change along, after;
    laconic_input and_along;
    laconic_start motion;
    laconic_real tangent[PARTS];
    laconic_state state = plant->state;
    memset(&along, 0, sizeof along);
    memset(&after, 0, sizeof after);
    memset(&and_along, 0, sizeof and_along);
    for (int k = 0; k < 3; k++) along.nu_rad_per_s[k] = (laconic_real)(byte(from) - 128) / 64;
    along.heading_rad = (laconic_real)(byte(from) - 128) / 64;
    if (plant->model.wheel_count > 0) and_along.voltage_V[0] = (laconic_real)(byte(from) - 128) / 64;
    and_along.body_moment_Nm = (laconic_real)(byte(from) - 128) / 64;
    const laconic_status status = laconic_step(&plant->model, &plant->integrator, &state, held);
    must(laconic_step_tangent(&after, &plant->model, &plant->integrator, &plant->state, held, &along, &and_along,
                              NULL) == status);
    motion_of(plant, &motion);
    if (status != LACONIC_OK || !is_usual(&motion, held, plant->model.wheel_count)) return;
    const int count = rows_of(tangent, &after, plant->model.wheel_count);
    if (!ends_before_its_solution(plant)) check_differences(plant, &motion, held, &along, &and_along, tangent, count);
    check_adjoint(plant, held, &along, &and_along, tangent, count, from);
}

/* ---------------------------------------------------------------------------------- pieces -- */

/* `steps` steps at once, and one by one from a copy of the motion; false where one was refused. */
static bool takes_steps(laconic_plant *plant, laconic_plant *twin, const laconic_input *input, uint64_t steps) {
    static saved now;
    laconic_refusal why = {0}, why_again = {0};
    laconic_status status = LACONIC_OK;
    save(&now, plant);
    restore(twin, &now);
    const uint64_t before = plant->steps;
    const laconic_real before_J = laconic_plant_energy_J(plant);
    must(laconic_plant_run(plant, input, steps, &why) == why.status);
    for (uint64_t k = 0; k < steps && status == LACONIC_OK; k++) {
        status = laconic_plant_run(twin, input, 1, &why_again);
        if (status != LACONIC_OK) save(&now, twin); /* after the steps that were taken */
    }
    must(why.status == status && same_refusal(&why, &why_again));
    if (status == LACONIC_OK) save(&now, twin);
    must(is_at(plant, &now) && is_finite_motion(plant));
    must(status != LACONIC_OK || plant->steps == before + steps);
    if (nothing_drives(plant, input)) check_energy(plant, before_J, plant->steps - before);
    return status == LACONIC_OK;
}

/* The motion of the bytes: ν is projected onto what the wheels allow, or is where they roll. */
static bool is_begun(laconic_plant *plant, reader *from) {
    laconic_start start;
    memset(&start, 0, sizeof start);
    for (int k = 0; k < 3; k++) start.nu_rad_per_s[k] = number(from);
    start.heading_rad = number(from);
    if (plant->friction.acts) return laconic_plant_restart(plant, &start, NULL) == LACONIC_OK;
    return laconic_state_project(&plant->state, &plant->model, &start, NULL) == LACONIC_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static laconic_plant plant, twin;
    static bool is_prepared;
    reader from = {data, data + size};
    if (!is_prepared) prepare_all();
    is_prepared = true;
    const uint8_t vehicle = byte(&from) % VEHICLES, method = byte(&from) % LACONIC_METHOD_COUNT;
    const laconic_plant *of = &prepared[vehicle][method][byte(&from) % SIZES];
    if (of->integrator.method == NULL) return 0; /* was refused */
    memcpy(&plant, of, sizeof plant);
    memcpy(&twin, of, sizeof twin);
    if (!is_begun(&plant, &from)) return 0;
    for (int k = 0; k < PIECES && from.at < from.end; k++) {
        laconic_input input;
        const uint8_t what = byte(&from);
        fill_input(&from, &input, plant.model.wheel_count);
        if (what >= 240U && k == 0 && !plant.friction.acts) check_tangent(&plant, &input, &from);
        if (!takes_steps(&plant, &twin, &input, 1U + (what & 1U))) break;
    }
    must(memcmp(&plant.model, &of->model, sizeof plant.model) == 0);
    return 0;
}
