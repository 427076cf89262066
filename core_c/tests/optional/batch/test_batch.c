/* Tests of batch.c: shapes, kinds, memory, the order of lanes; of batch_articulated.c: lanes with hinges. */
#include "../articulated_friction/slipping_trees.h"
#include "population.h"

static population all;
static laconic_refusal why;

static laconic_batch_kind kind_of(laconic_vehicle v, const laconic_method *method) {
    laconic_batch_kind kind;
    ASSERT_STATUS(LACONIC_OK, laconic_batch_kind_of(&kind, &v, method, REAL(0.01), &why));
    return kind;
}

static laconic_batch_shape shape_of(int32_t lanes, int32_t kinds) {
    const laconic_batch_shape shape = {lanes, kinds, 4, 0};
    return shape;
}

static void *memory(void) { return (void *)(((uintptr_t)all.memory + 63) / 64 * 64); }

static void a_shape_out_of_bounds_has_no_size(void) {
    const laconic_batch_shape wrong[] = {{0, 1, 3, 0},  {1, 0, 3, 0},
                                         {2, 3, 3, 0},  {(1 << 28) + 1, 1, 3, 0},
                                         {1, 1, -1, 0}, {1, 1, LACONIC_MAX_WHEELS + 1, 0},
                                         {1, 1, 3, 2},  {1, 1, 3, -1}};
    const laconic_batch_kind kind = kind_of(three_wheels(), &laconic_rk4);
    laconic_batch batch;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        TEST_ASSERT_EQUAL_UINT64(0, laconic_batch_size(&wrong[i]));
        TEST_ASSERT_FALSE(laconic_batch_place(&batch, memory(), &wrong[i], &kind, NULL));
    }
}

static void what_does_not_fit_is_not_placed(void) {
    const laconic_batch_kind kinds[1] = {kind_of(mecanum(), &laconic_rk4)};
    const laconic_batch_shape fits = shape_of(2, 1), few_wheels = {2, 1, 3, 0};
    const int32_t beyond[2] = {0, 1}, below[2] = {0, -1};
    laconic_batch batch;
    TEST_ASSERT_FALSE(laconic_batch_place(&batch, (char *)memory() + 8, &fits, kinds, NULL));
    TEST_ASSERT_FALSE(laconic_batch_place(&batch, memory(), &few_wheels, kinds, NULL));
    TEST_ASSERT_FALSE(laconic_batch_place(&batch, memory(), &fits, kinds, beyond));
    TEST_ASSERT_FALSE(laconic_batch_place(&batch, memory(), &fits, kinds, below));
    TEST_ASSERT_TRUE(laconic_batch_place(&batch, memory(), &fits, kinds, NULL));
}

static void a_kind_is_refused_as_its_parts_are(void) {
    laconic_batch_kind kind;
    laconic_vehicle v = with_motors(three_wheels());
    ASSERT_REFUSED(LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD, 0,
                   laconic_batch_kind_of(&kind, &v, NULL, REAL(0.01), &why), why);
    v.ground.friction_coefficient = REAL(0.5);
    ASSERT_REFUSED(LACONIC_METHOD_WITHOUT_FRICTION, LACONIC_FIELD_METHOD, 0,
                   laconic_batch_kind_of(&kind, &v, &laconic_auto, REAL(0.01), &why), why);
    v.mass_kg = REAL(0);
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_MASS, 0,
                   laconic_batch_kind_of(&kind, &v, &laconic_auto, REAL(0.01), &why), why);
}

static void the_widest_registers_are_taken_unless_one_width_is_named(void) {
    const int32_t widest = laconic_batch_width(0);
    TEST_ASSERT_TRUE(widest == 64 || widest == 32 || widest == 16 || widest == 1);
    TEST_ASSERT_EQUAL_INT(1, laconic_batch_width(1));
    TEST_ASSERT_EQUAL_INT(widest, laconic_batch_width(widest));
    TEST_ASSERT_EQUAL_INT(0, laconic_batch_width(8));
}

static void lanes_keep_their_places_whatever_the_order_of_blocks(void) {
    fill(&all, 0);
    for (int i = 0; i < LANES; i++) {
        laconic_state state = all.states[i];
        laconic_input input;
        laconic_batch_store(&all.batch, i, &state);
        TEST_ASSERT_EQUAL_MEMORY(&all.states[i], &state, sizeof state);
        random_input(&all, &all.inputs[i]);
        input = all.inputs[i];
        laconic_batch_set_input(&all.batch, i, &all.inputs[i]);
        laconic_batch_input(&all.batch, i, &input);
        TEST_ASSERT_EQUAL_MEMORY(&all.inputs[i], &input, sizeof input);
    }
}

/* Lane 5 becomes the vehicle of another kind: it, and no other lane, then steps as that does alone. */
static void a_lane_whose_kind_changed_steps_as_the_new_one(void) {
    static laconic_batch_kind kinds[16];
    laconic_batch_kind heavy;
    laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = {.voltage_V = {REAL(4), REAL(-2), REAL(1)}};
    const laconic_start start = {.nu_rad_per_s = {REAL(1), REAL(-1), REAL(2)}};
    const int32_t own[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const laconic_batch_shape shape = shape_of(16, 16);
    laconic_batch batch;
    for (int i = 0; i < 16; i++) kinds[i] = kind_of(v, &laconic_rk4);
    v.mass_kg *= REAL(2);
    heavy = kind_of(v, &laconic_rk4);
    TEST_ASSERT_TRUE(laconic_batch_place(&batch, memory(), &shape, kinds, own));
    kinds[5] = heavy;
    TEST_ASSERT_TRUE(laconic_batch_renew(&batch, 5));
    for (int i = 0; i < 16; i++) {
        laconic_state state;
        ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &kinds[i].model, &start, &why));
        laconic_batch_load(&batch, i, &state);
        laconic_batch_set_input(&batch, i, &input);
    }
    TEST_ASSERT_EQUAL_INT(0, laconic_batch_run(&batch, 0, batch.block_count, 3));
    for (int i = 0; i < 16; i++) {
        laconic_state alone, lane;
        laconic_status status;
        ASSERT_STATUS(LACONIC_OK, laconic_state_set(&alone, &kinds[i].model, &start, &why));
        lane = alone;
        laconic_run(&kinds[i].model, &kinds[i].integrator, &alone, &input, 3, &status);
        laconic_batch_store(&batch, i, &lane);
        TEST_ASSERT_EQUAL_MEMORY(&alone, &lane, sizeof alone);
    }
}

static void a_kind_that_is_stepped_in_another_way_is_not_renewed(void) {
    static laconic_batch_kind kinds[40];
    static int32_t own[40];
    const laconic_batch_shape shape = shape_of(40, 40);
    laconic_batch batch;
    for (int i = 0; i < 40; i++) {
        kinds[i] = kind_of(with_motors(three_wheels()), i % 2 ? &laconic_rk4 : &laconic_taylor_8);
        own[i] = i;
    }
    TEST_ASSERT_TRUE(laconic_batch_place(&batch, memory(), &shape, kinds, own));
    for (int i = 0; i < 40; i++) TEST_ASSERT_TRUE(laconic_batch_renew(&batch, i));
    kinds[20] = kind_of(with_motors(three_wheels()), &laconic_rk4);
    kinds[21] = kind_of(mecanum(), &laconic_rk4);
    TEST_ASSERT_FALSE(laconic_batch_renew(&batch, 20));
    TEST_ASSERT_FALSE(laconic_batch_renew(&batch, 21));
    TEST_ASSERT_TRUE(laconic_batch_renew(&batch, 22));
}

/* -------------------------------------------------------------------------- vehicles with hinges -- */

enum { HINGED_LANES = 4 };

/* Lanes 0 and 2 roll, 1 and 3 slip; lane 2 has a motion that no step can go on with. */
static void lanes_with_hinges_have_the_bits_of_single_steps_and_stop_alone(void) {
    const laconic_articulated_model rolling = hinged_model(with_two_casters());
    const laconic_tree_model slipping = tree_model(tree_casters());
    laconic_articulated_kind kinds[2];
    static const int32_t kind_of_lane[HINGED_LANES] = {0, 1, 0, 1};
    laconic_articulated_state states[HINGED_LANES];
    laconic_tree_state trees[HINGED_LANES];
    laconic_articulated_input inputs[HINGED_LANES];
    laconic_tree_input tree_inputs[HINGED_LANES];
    laconic_refusal whys[HINGED_LANES];
    int32_t status[HINGED_LANES];
    uint64_t missed[HINGED_LANES] = {0, 0, 0, 5};
    const laconic_articulated_start start = start_at(0.4, 0, 0.1);
    const laconic_tree_start tree_start = tree_start_at(0.4, 0, 0.1);
    memset(kinds, 0, sizeof kinds);
    kinds[0].model = &rolling;
    kinds[0].integrator = hinged_integrator(&rolling, LACONIC_ARTICULATED_AUTO, 0.01);
    kinds[1].tree = &slipping;
    kinds[1].tree_step_s = REAL(0.002);
    for (int k = 0; k < HINGED_LANES; k++) {
        inputs[k] = nothing();
        tree_inputs[k] = tree_nothing();
        inputs[k].base.voltage_V[0] = tree_inputs[k].hinged.base.voltage_V[0] = REAL(2 + k);
        states[k] = hinged_state(&rolling, &start, &inputs[k]);
        trees[k] = tree_state(&slipping, &tree_start);
    }
    states[2].heading.turns = INT64_MAX;
    laconic_articulated_state state = states[0];
    laconic_tree_state tree = trees[3];
    const laconic_articulated_state stuck = states[2];
    laconic_articulated_batch batch = {kinds, kind_of_lane, states, inputs, trees, tree_inputs, whys, status, missed};
    TEST_ASSERT_EQUAL_INT32(0, laconic_articulated_batch_run(&batch, 0, 2, 7));
    TEST_ASSERT_EQUAL_INT32(1, laconic_articulated_batch_run(&batch, 2, 2, 7));
    for (int k = 0; k < 7; k++)
        ASSERT_TAKEN(
            laconic_articulated_step(&rolling, &kinds[0].integrator, &state, &inputs[0], &inputs[0], &refusal));
    tree_run(&slipping, &tree, &tree_inputs[3], 0.002, 7);
    TEST_ASSERT_EQUAL_MEMORY(&state, &states[0], sizeof state);
    TEST_ASSERT_EQUAL_MEMORY(&tree, &trees[3], sizeof tree);
    TEST_ASSERT_EQUAL_MEMORY(&stuck, &states[2], sizeof stuck);
    TEST_ASSERT_EQUAL_INT32(LACONIC_OVERFLOW, status[2]);
    ASSERT_STATUS(LACONIC_OVERFLOW, whys[2].status);
    TEST_ASSERT_EQUAL_UINT64(7, missed[2]);
    TEST_ASSERT_EQUAL_UINT64(5, missed[3]);
    laconic_articulated_motion motions[2];
    laconic_articulated_batch_observe(&batch, 0, 2, motions);
    TEST_ASSERT_TRUE(motions[0].x_m == motion_of(&rolling, &state).x_m && motions[0].x_m != 0);
    TEST_ASSERT_TRUE(motions[1].x_m == tree_outputs(&slipping, &trees[1]).motion.x_m && motions[1].x_m != 0);
    laconic_tree_outputs outputs;
    laconic_articulated_batch_outputs(&batch, 3, 1, &outputs);
    const laconic_tree_outputs wanted = tree_outputs(&slipping, &tree);
    TEST_ASSERT_EQUAL_MEMORY(wanted.normal_N, outputs.normal_N, 4 * sizeof outputs.normal_N[0]);
    TEST_ASSERT_TRUE(outputs.motor_loss_J == wanted.motor_loss_J && wanted.motor_loss_J > 0);
}

int main(void) {
    all.random = 20;
    UNITY_BEGIN();
    RUN_TEST(a_shape_out_of_bounds_has_no_size);
    RUN_TEST(what_does_not_fit_is_not_placed);
    RUN_TEST(a_kind_is_refused_as_its_parts_are);
    RUN_TEST(the_widest_registers_are_taken_unless_one_width_is_named);
    RUN_TEST(lanes_keep_their_places_whatever_the_order_of_blocks);
    RUN_TEST(a_lane_whose_kind_changed_steps_as_the_new_one);
    RUN_TEST(a_kind_that_is_stepped_in_another_way_is_not_renewed);
    RUN_TEST(lanes_with_hinges_have_the_bits_of_single_steps_and_stop_alone);
    return UNITY_END();
}
