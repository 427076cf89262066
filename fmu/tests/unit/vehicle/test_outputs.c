/* Tests of when outputs are computed: each is that of the present state and input whichever is read first, and what
 * nobody asks for is not computed. */
#include "fmi2_bench.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

/* ------------------------------------------------------------------------------ vehicles that move -- */

enum { IDEAL, SLIPS, ROLLS, GROUNDS };

static void with_limits(void) {
    set("supply_V", 0, 9);
    set("supply_resistance_ohm", 0, 0.1);
    set("winding_resistance_ohm", 0, 1.5);
}

static void begin(fmi2Type kind, int ground) {
    make(kind);
    if (kind == fmi2CoSimulation) set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0);
    set("com_z_m", 0, 0.05);
    if (ground != IDEAL) with_limits();
    if (ground == SLIPS) set("ground_friction_coefficient", 0, 0.4);
    if (ground == SLIPS) set("ground_roller_drag", 0, 0.2);
    fmu_model_made(&instance()->model);
    initialise();
    if (kind == fmi2ModelExchange) OK(fmi2EnterContinuousTimeMode(c));
}

static void drive(double by) {
    for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, by * (4.0 * k - 7));
    set("axle_torque_Nm", 2, 0.1 * by);
    set("body_force_N", 1, by);
}

/* To the place of that number: by a step, or as a solver does. */
static void move(fmi2Type kind, int place) {
    double state[14];
    const uint32_t count = fmu_model_state_count(&instance()->model);
    for (uint32_t k = 0; k < count; k++) state[k] = sin(place + 0.7 * k);
    if (kind == fmi2CoSimulation)
        OK(step(0.01 * place, 0.01));
    else
        OK(fmi2SetContinuousStates(c, state, count));
}

static const char *const outputs[] = {"nu_rad_per_s",
                                      "x_m",
                                      "heading_rad",
                                      "wheel_angle_rad",
                                      "heading_wrapped_rad",
                                      "origin_x_m",
                                      "origin_y_m",
                                      "velocity_body_m_per_s",
                                      "yaw_rate_rad_per_s",
                                      "wheel_speed_rad_per_s",
                                      "wheel_torque_Nm",
                                      "wheel_reaction_N",
                                      "wheel_lateral_N",
                                      "no_slip_margin_N",
                                      "energy_J",
                                      "der(nu_rad_per_s)",
                                      "der(x_m)",
                                      "der(heading_rad)",
                                      "der(wheel_angle_rad)",
                                      "der(wheel_speed_rad_per_s)",
                                      "slip_along_m_per_s",
                                      "contact_state",
                                      "drive_limit",
                                      "motor_current_A",
                                      "supply_current_A",
                                      "supply_voltage_V",
                                      "slip_loss_J",
                                      "acceleration_body_m_per_s2"};
#define OUTPUTS (sizeof outputs / sizeof outputs[0])

static double read_output(size_t k) {
    const uint32_t row = ref(outputs[k], 0);
    return get(outputs[k], fmu_variables[row].size == 1 ? 0 : 1);
}

static void read_all(double values[OUTPUTS]) {
    for (size_t k = 0; k < OUTPUTS; k++) values[k] = read_output(k);
}

/* ------------------------------------------------------------------------------------- what is read -- */

/* After all were read elsewhere: one is read, then all. `with_input`: it has changed, and nothing has moved. */
static void each_first(fmi2Type kind, int ground, bool with_input) {
    double all[OUTPUTS], usual[OUTPUTS];
    for (size_t first = 0; first < OUTPUTS; first++) {
        begin(kind, ground);
        drive(1);
        move(kind, 0);
        if (with_input) move(kind, 1);
        read_all(all);
        if (with_input)
            drive(-0.6);
        else
            move(kind, 1);
        const double found = read_output(first);
        read_all(first == 0 ? usual : all);
        if (first == 0) continue;
        TEST_ASSERT_TRUE_MESSAGE(found == all[first], outputs[first]);
        for (size_t k = 0; k < OUTPUTS; k++) TEST_ASSERT_TRUE_MESSAGE(all[k] == usual[k], outputs[k]);
    }
}

static void an_output_is_the_same_whichever_is_read_first(void) {
    for (int ground = 0; ground < GROUNDS; ground++) {
        for (int with_input = 0; with_input < 2; with_input++) {
            each_first(fmi2CoSimulation, ground, with_input == 1);
            each_first(fmi2ModelExchange, ground, with_input == 1);
        }
    }
}

/* In initialization mode each start value counts, also where outputs were read before it was set. */
static void a_start_value_counts_for_outputs_that_were_read_before(void) {
    OK(fmi2EnterInitializationMode(c));
    TEST_ASSERT_TRUE(get("x_m", 0) == 0 && get("energy_J", 0) == 0);
    set("start_x_m", 0, 3);
    set("start_nu_rad_per_s", 1, 2);
    TEST_ASSERT_TRUE(get("energy_J", 0) > 0);
    TEST_ASSERT_TRUE(get("x_m", 0) == 3);
    OK(fmi2ExitInitializationMode(c));
}

/* ------------------------------------------------------------------------------------ what is asked -- */

#define MEMBER(group, member) \
    {group, (uint32_t)offsetof(fmu_model, member), (uint32_t)sizeof(((fmu_model *)NULL)->member)}

/* Where each group's outputs stand, doubles all. */
static const struct {
    uint32_t group, offset, size;
} members[] = {MEMBER(FMU_GROUP_MOTION, nu),
               MEMBER(FMU_GROUP_MOTION, x_m),
               MEMBER(FMU_GROUP_MOTION, heading_rad),
               MEMBER(FMU_GROUP_ANGLES, wheel_angle_rad),
               MEMBER(FMU_GROUP_POSE, pose),
               MEMBER(FMU_GROUP_VELOCITY, velocity_m_per_s),
               MEMBER(FMU_GROUP_VELOCITY, yaw_rate_rad_per_s),
               MEMBER(FMU_GROUP_SPEEDS, wheel_speed_rad_per_s),
               MEMBER(FMU_GROUP_TORQUES, wheel_torque_Nm),
               MEMBER(FMU_GROUP_ENERGY, energy_J),
               MEMBER(FMU_GROUP_GROUND, ground),
               MEMBER(FMU_GROUP_RATES, rates),
               MEMBER(FMU_GROUP_FRICTION, friction),
               MEMBER(FMU_GROUP_TORQUES | FMU_GROUP_GROUND | FMU_GROUP_FRICTION, plant.slip.current_A),
               MEMBER(FMU_GROUP_ACCELERATION, sensed.acceleration_body_m_per_s2),
               MEMBER(FMU_GROUP_SENSORS, sensed.imu_acceleration_m_per_s2),
               MEMBER(FMU_GROUP_SENSORS, sensed.imu_yaw_rate_rad_per_s)};
#define MEMBERS (sizeof members / sizeof members[0])

static double *doubles_of(size_t n) { return (double *)(void *)((char *)&instance()->model + members[n].offset); }

/* What this group is computed from, itself among it: fresh afterwards, but what only the same call has used. */
static uint32_t closure(fmi2Type kind, int ground, uint32_t group, uint32_t *used) {
    const bool continuous = kind == fmi2ModelExchange;
    uint32_t fresh = group;
    if (continuous && ground != IDEAL && group == FMU_GROUP_ACCELERATION) fresh |= FMU_GROUP_RATES;
    if (fresh & FMU_GROUP_RATES) fresh |= FMU_GROUP_MOTION;
    if (fresh & FMU_GROUP_RATES && ground == SLIPS) fresh |= FMU_GROUP_SPEEDS;
    if (fresh & FMU_GROUP_RATES && ground == ROLLS) fresh |= FMU_GROUP_TORQUES;
    *used = fresh;
    if (continuous && ground != IDEAL && group == FMU_GROUP_FRICTION) *used |= FMU_GROUP_GROUND;
    if (continuous && ground == ROLLS && *used & FMU_GROUP_GROUND) *used |= FMU_GROUP_TORQUES;
    if (continuous && ground == ROLLS) *used |= FMU_GROUP_SPEEDS; /* with the state */
    return fresh;
}

static void ask_for(fmi2Type kind, int ground, uint32_t group) {
    fmu_model *model = &instance()->model;
    const bool continuous = kind == fmi2ModelExchange;
    const uint32_t states = continuous ? FMU_GROUPS_OF_CONTINUOUS_STATES(model) : 0;
    uint32_t used;
    const uint32_t fresh = closure(kind, ground, group, &used);
    move(kind, 1);
    TEST_ASSERT_EQUAL_HEX32(continuous ? FMU_GROUPS_ALL & ~states : FMU_GROUPS_ALL & ~FMU_GROUP_STATE, model->stale);
    for (size_t n = 0; n < MEMBERS; n++)
        if (!(members[n].group & states))
            for (size_t k = 0; k < members[n].size / sizeof(double); k++) doubles_of(n)[k] = 77;
    const uint32_t before = model->stale;
    fmu_model_refresh(instance(), group);
    /* in Model Exchange with the plant's state, which rates do not need: a solver asks for them alone */
    const bool by_states = (group & states) != 0 || (group == FMU_GROUP_RATES && ground != ROLLS);
    const uint32_t state = continuous && !by_states ? FMU_GROUP_STATE : 0;
    TEST_ASSERT_EQUAL_HEX32(before & ~fresh & ~state, model->stale);
    for (size_t n = 0; n < MEMBERS; n++) {
        if ((members[n].group & (states | used)) != 0) continue;
        for (size_t k = 0; k < members[n].size / sizeof(double); k++) TEST_ASSERT_TRUE(doubles_of(n)[k] == 77);
    }
}

/* Each group by itself; afterwards it counts as fresh, and the others do not. */
static void what_nobody_asks_for_is_not_computed(void) {
    static const fmi2Type kinds[2] = {fmi2CoSimulation, fmi2ModelExchange};
    for (int n = 0; n < 2; n++) {
        for (int ground = 0; ground < GROUNDS; ground++) {
            for (uint32_t group = FMU_GROUP_MOTION; group <= FMU_GROUP_ESTIMATE; group *= 2) {
                if (!(group & FMU_GROUPS_ALL)) continue;
                begin(kinds[n], ground);
                drive(1);
                move(kinds[n], 0);
                ask_for(kinds[n], ground, group);
            }
        }
    }
}

/* Nothing needs to be computed for them. */
static void parameters_and_inputs_are_read_though_the_model_cannot_start(void) {
    double real;
    set("mass_kg", 0, 0);
    OK(fmi2EnterInitializationMode(c));
    for (uint32_t row = 0; row < fmu_variable_count; row++) {
        const fmu_variable *variable = &fmu_variables[row];
        const uint32_t reference = variable->size == 1 ? row : row << FMU_ELEMENT_SHIFT | 1;
        int whole;
        if (variable->access >= FMU_STATE) continue;
        if (variable->type == FMU_REAL)
            OK(fmi2GetReal(c, &reference, 1, &real));
        else if (variable->type == FMU_BOOLEAN)
            OK(fmi2GetBoolean(c, &reference, 1, &whole));
        else
            OK(fmi2GetInteger(c, &reference, 1, &whole));
    }
    ASSERT_REFUSED(try_get("x_m", 0, &real), "this vehicle cannot start: mass_kg");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_output_is_the_same_whichever_is_read_first);
    RUN_TEST(a_start_value_counts_for_outputs_that_were_read_before);
    RUN_TEST(what_nobody_asks_for_is_not_computed);
    RUN_TEST(parameters_and_inputs_are_read_though_the_model_cannot_start);
    return UNITY_END();
}
