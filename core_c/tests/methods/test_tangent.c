/* Tests of the analytic derivatives against central differences, along directions that vary all states and inputs. */
#include "vehicles.h"

#define SMALL EITHER(1e-5, 5e-3)
#define TOLERANCE EITHER(2e-8, 2e-2)
#define DIRECTIONS 4

typedef struct point {
    laconic_start motion;
    laconic_input input;
} point;

static laconic_variation direction_number(int n) {
    laconic_variation by;
    memset(&by, 0, sizeof by);
    for (int i = 0; i < 3; i++) by.nu_rad_per_s[i] = REAL(0.3 * n - 0.5 * i + 0.2);
    by.x_m = REAL(0.4 - 0.1 * n);
    by.y_m = REAL(-0.3 + 0.2 * n);
    by.heading_rad = REAL(0.7 - 0.4 * n);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        by.input.voltage_V[i] = REAL(0.6 - 0.3 * i + 0.1 * n);
        by.input.axle_torque_Nm[i] = REAL(0.02 * i - 0.01 * n);
    }
    by.input.body_force_N[0] = REAL(0.5 - 0.2 * n);
    by.input.body_force_N[1] = REAL(0.1 * n);
    by.input.body_moment_Nm = REAL(0.05 - 0.03 * n);
    by.input.world_force_N[0] = REAL(0.4);
    by.input.world_force_N[1] = REAL(-0.3 * n);
    by.input.world_force_point_m[0] = REAL(0.06 * n);
    by.input.world_force_point_m[1] = REAL(-0.04);
    return by;
}

static laconic_real moved(laconic_real from, double by, laconic_real along) { return from + REAL(by) * along; }

static point varied(const point *p, const laconic_variation *by, double step) {
    point q = *p;
    for (int i = 0; i < 3; i++) q.motion.nu_rad_per_s[i] = moved(q.motion.nu_rad_per_s[i], step, by->nu_rad_per_s[i]);
    q.motion.x_m = moved(q.motion.x_m, step, by->x_m);
    q.motion.y_m = moved(q.motion.y_m, step, by->y_m);
    q.motion.heading_rad = moved(q.motion.heading_rad, step, by->heading_rad);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        q.input.voltage_V[i] = moved(q.input.voltage_V[i], step, by->input.voltage_V[i]);
        q.input.axle_torque_Nm[i] = moved(q.input.axle_torque_Nm[i], step, by->input.axle_torque_Nm[i]);
    }
    for (int i = 0; i < 2; i++) {
        q.input.body_force_N[i] = moved(q.input.body_force_N[i], step, by->input.body_force_N[i]);
        q.input.world_force_N[i] = moved(q.input.world_force_N[i], step, by->input.world_force_N[i]);
        q.input.world_force_point_m[i] = moved(q.input.world_force_point_m[i], step, by->input.world_force_point_m[i]);
    }
    q.input.body_moment_Nm = moved(q.input.body_moment_Nm, step, by->input.body_moment_Nm);
    return q;
}

static point somewhere(void) {
    point p = {start_with(0.8, -0.5, 1.4), every_input()};
    p.motion.heading_rad = REAL(0.9);
    return p;
}

static laconic_motion motion_of(const point *p) {
    laconic_motion at;
    memcpy(at.nu_rad_per_s, p->motion.nu_rad_per_s, sizeof at.nu_rad_per_s);
    at.heading_rad = p->motion.heading_rad;
    return at;
}

/* All outputs that are compared at a point, in one array. */
typedef struct numbers {
    double n[80];
    int count;
} numbers;

static void take(numbers *all, const laconic_real *from, int count) {
    for (int i = 0; i < count; i++) all->n[all->count++] = (double)from[i];
}

static numbers rates_at(const laconic_model *m, const point *p) {
    numbers all = {{0}, 0};
    laconic_rates rates;
    laconic_derivative(&rates, m, p->motion.nu_rad_per_s, p->motion.heading_rad, &p->input);
    take(&all, rates.nu_rad_per_s2, 3);
    take(&all, &rates.x_m_per_s, 1);
    take(&all, &rates.y_m_per_s, 1);
    take(&all, &rates.yaw_rate_rad_per_s, 1);
    take(&all, rates.wheel_speed_rad_per_s, m->wheel_count);
    return all;
}

static numbers rate_changes(const laconic_model *m, const point *p, const laconic_variation *by) {
    const laconic_motion at = motion_of(p);
    numbers all = {{0}, 0};
    laconic_rates change;
    laconic_derivative_tangent(&change, m, &at, &p->input, by);
    take(&all, change.nu_rad_per_s2, 3);
    take(&all, &change.x_m_per_s, 1);
    take(&all, &change.y_m_per_s, 1);
    take(&all, &change.yaw_rate_rad_per_s, 1);
    take(&all, change.wheel_speed_rad_per_s, m->wheel_count);
    return all;
}

static laconic_state placed(const laconic_model *m, const point *p) {
    laconic_state state;
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(&state, m, &p->motion, NULL));
    return state;
}

static numbers outputs_at(const laconic_model *m, const point *p) {
    const laconic_state state = placed(m, p);
    numbers all = {{0}, 0};
    laconic_pose pose;
    laconic_real velocity[2], yaw_rate, speed[LACONIC_MAX_WHEELS], torque[LACONIC_MAX_WHEELS], energy;
    laconic_pose_of(&pose, m, &state);
    yaw_rate = laconic_body_velocity(m, &state, velocity);
    laconic_wheel_speeds(m, &state, speed);
    laconic_wheel_torques(m, &state, &p->input, torque);
    energy = laconic_energy_J(m, &state);
    take(&all, &pose.origin_x_m, 1);
    take(&all, &pose.origin_y_m, 1);
    take(&all, velocity, 2);
    take(&all, &yaw_rate, 1);
    take(&all, speed, m->wheel_count);
    take(&all, torque, m->wheel_count);
    take(&all, &energy, 1);
    return all;
}

static numbers output_changes(const laconic_model *m, const point *p, const laconic_variation *by) {
    const laconic_motion at = motion_of(p);
    numbers all = {{0}, 0};
    laconic_motion_change change;
    laconic_motion_tangent(&change, m, &at, by);
    take(&all, &change.origin_x_m, 1);
    take(&all, &change.origin_y_m, 1);
    take(&all, change.velocity_m_per_s, 2);
    take(&all, &change.yaw_rate_rad_per_s, 1);
    take(&all, change.wheel_speed_rad_per_s, m->wheel_count);
    take(&all, change.wheel_torque_Nm, m->wheel_count);
    take(&all, &change.energy_J, 1);
    return all;
}

static void agree(numbers expected_high, numbers expected_low, numbers change) {
    TEST_ASSERT_EQUAL_INT(expected_high.count, change.count);
    for (int i = 0; i < change.count; i++) {
        const double difference = (expected_high.n[i] - expected_low.n[i]) / (2 * SMALL);
        ASSERT_NEAR(TOLERANCE * (1 + fabs(difference)), difference, change.n[i]);
    }
}

static void rates_and_outputs_change_as_differences_say(laconic_vehicle v) {
    const laconic_model m = model_of(v);
    const point p = somewhere();
    for (int n = 0; n < DIRECTIONS; n++) {
        const laconic_variation by = direction_number(n);
        const point high = varied(&p, &by, SMALL), low = varied(&p, &by, -SMALL);
        agree(rates_at(&m, &high), rates_at(&m, &low), rate_changes(&m, &p, &by));
        agree(outputs_at(&m, &high), outputs_at(&m, &low), output_changes(&m, &p, &by));
    }
}

static void every_vehicle_is_linearised(void) {
    laconic_vehicle locked = with_motors(three_wheels());
    locked.wheel[2].locked = true;
    rates_and_outputs_change_as_differences_say(with_motors(three_wheels()));
    rates_and_outputs_change_as_differences_say(with_motors(mecanum()));
    rates_and_outputs_change_as_differences_say(with_motors(differential_drive()));
    rates_and_outputs_change_as_differences_say(caster());
    rates_and_outputs_change_as_differences_say(with_own_wheels(with_motors(mecanum())));
    rates_and_outputs_change_as_differences_say(with_own_wheels(with_motors(differential_drive())));
    rates_and_outputs_change_as_differences_say(bare_body());
    rates_and_outputs_change_as_differences_say(locked);
}

static laconic_reactions reactions_at(const laconic_contact *c, const laconic_model *m, const point *p) {
    const laconic_state state = placed(m, p);
    laconic_reactions out;
    memset(&out, 0, sizeof out);
    laconic_reactions_of(&out, c, m, &state, &p->input);
    return out;
}

static numbers numbers_of(const laconic_contact *c, const laconic_model *m, const laconic_reactions *r) {
    numbers all = {{0}, 0};
    take(&all, r->along_N, m->wheel_count);
    take(&all, r->lateral_N, m->wheel_count);
    take(&all, r->brake_Nm, m->wheel_count);
    take(&all, r->normal_N, c->point_count);
    take(&all, &r->no_slip_margin_N, 1);
    return all;
}

/* `pushed`: the wheel that gets a torque of its own, so that its margin is the least. */
static void reactions_change_as_differences_say(laconic_vehicle v, int pushed) {
    point p = somewhere();
    const laconic_motion at = motion_of(&p);
    laconic_model m;
    laconic_contact c;
    laconic_reactions now;
    p.input.axle_torque_Nm[pushed] += REAL(1);
    v.com_z_m = REAL(0.1);
    v.friction_coefficient = REAL(0.5);
    m = model_of(v);
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&c, &v, NULL));
    now = reactions_at(&c, &m, &p);
    for (int n = 0; n < DIRECTIONS; n++) {
        const laconic_variation by = direction_number(n);
        const point high = varied(&p, &by, SMALL), low = varied(&p, &by, -SMALL);
        const laconic_reactions up = reactions_at(&c, &m, &high), down = reactions_at(&c, &m, &low);
        laconic_reactions change;
        memset(&change, 0, sizeof change);
        laconic_reactions_tangent(&change, &c, &m, &at, &p.input, &now, &by);
        agree(numbers_of(&c, &m, &up), numbers_of(&c, &m, &down), numbers_of(&c, &m, &change));
    }
}

static void reactions_of_every_vehicle_are_linearised(void) {
    laconic_vehicle v = with_motors(three_wheels());
    reactions_change_as_differences_say(v, 0);
    reactions_change_as_differences_say(v, 2);
    v.wheel[2].locked = true;
    reactions_change_as_differences_say(v, 0);
    reactions_change_as_differences_say(with_motors(mecanum()), 3);
    reactions_change_as_differences_say(with_own_wheels(with_motors(mecanum())), 3);
    v = with_motors(differential_drive());
    v.support_count = 1;
    v.support[0].y_m = REAL(0.1);
    reactions_change_as_differences_say(v, 0);
    reactions_change_as_differences_say(bare_body(), 0);
}

static void a_reaction_of_zero_counts_as_constant(void) {
    laconic_vehicle v = three_wheels();
    const laconic_model m = model_of(v);
    const laconic_state rest = moving(&m, 0, 0, 0);
    const laconic_input input = no_input();
    const laconic_variation by = direction_number(1);
    laconic_motion at;
    laconic_contact c;
    laconic_reactions now, change;
    memset(&at, 0, sizeof at);
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&c, &v, NULL));
    laconic_reactions_of(&now, &c, &m, &rest, &input);
    laconic_reactions_tangent(&change, &c, &m, &at, &input, &now, &by);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)change.no_slip_margin_N);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_vehicle_is_linearised);
    RUN_TEST(reactions_of_every_vehicle_are_linearised);
    RUN_TEST(a_reaction_of_zero_counts_as_constant);
    return UNITY_END();
}
