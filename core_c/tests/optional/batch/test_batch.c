/* Tests of batch.c: shapes, kinds, memory, and the order of lanes. */
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
    return UNITY_END();
}
