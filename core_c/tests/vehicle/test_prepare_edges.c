/* Tests of prepare.c at the edges of its tolerances and at the end of the range. */
#include "elementary.h"
#include "vehicles.h"

static laconic_refusal why;

/* Rollers on wheels so large that squares of their rows have few digits: the shares of damping that is the same
 * for all are 1, and so are those of none. */
static void axes_are_the_same_without_damping_where_rows_hardly_are_numbers(void) {
    laconic_vehicle v = three_wheels();
    v.wheel_inertia_kgm2 = 0;
    for (int i = 0; i < 3; i++) {
        v.wheel[i].own_radius_m = EITHER(REAL(1e153), REAL(1e18));
        v.wheel[i].axle_rad += REAL(0.3 * i);
        v.wheel[i].roller_rad = REAL(1 + 0.2 * i);
    }
    const laconic_model without = model_of(v);
    v.motor_damping_Nms = REAL(DAMPING);
    const laconic_model with = model_of(v);
    TEST_ASSERT_EQUAL_MEMORY(with.nu_of_zeta, without.nu_of_zeta, sizeof with.nu_of_zeta);
    TEST_ASSERT_EQUAL_MEMORY(with.wheel_of_zeta, without.wheel_of_zeta, sizeof with.wheel_of_zeta);
}

/* Of wheels without inertia the columns stay as they were rotated. For some vehicles such small rotations would go on
 * for ever; for this one they end, and tell the bound. */
static void columns_are_rotated_until_a_quarter_of_the_last_digit_is_left(void) {
    laconic_vehicle v = bare_body();
    v.mass_kg = 9;
    v.yaw_inertia_kgm2 = REAL(0.125);
    v.wheel_radius_m = REAL(0.1875);
    v.wheel_inertia_kgm2 = 0;
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.375, -0.4375, -1.25, 1.25);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.1875, -0.4375, 2.75, 1);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.0625, -0.0625, -0.75, 2);
    const laconic_model m = model_of(v);
    for (int a = 0; a < 3; a++) {
        for (int b = a + 1; b < 3; b++) {
            laconic_real aa = 0, bb = 0, ab = 0;
            for (int i = 0; i < 3; i++) {
                aa += m.wheel_of_zeta[i][a] * m.wheel_of_zeta[i][a];
                bb += m.wheel_of_zeta[i][b] * m.wheel_of_zeta[i][b];
                ab += m.wheel_of_zeta[i][a] * m.wheel_of_zeta[i][b];
            }
            TEST_ASSERT_TRUE(magnitude(ab) <= REAL(0.25) * LACONIC_EPSILON * laconic_root(aa) * laconic_root(bb));
        }
    }
}

/* Two wheels under the mass centre whose axles differ by just the tolerance, and by the next number. */
static void axle_lines_that_differ_by_just_the_tolerance_count_once(void) {
    laconic_vehicle v = bare_body();
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.0, 0.0, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.0, 0.0, 0.0);
    v.wheel[1].axle_rad = LACONIC_RANK_TOLERANCE;
    TEST_ASSERT_EQUAL_INT(2, model_of(v).dof);
    v.wheel[1].axle_rad *= 1 + LACONIC_EPSILON;
    TEST_ASSERT_EQUAL_INT(1, model_of(v).dof);
}

/* Axle lines that meet so far away that the one motion turns by just the tolerance; the next number is beyond. */
static void axle_lines_that_meet_at_just_the_tolerance_leave_a_rotation(void) {
    laconic_vehicle v = bare_body();
    laconic_model model;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.05, 0.0, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, -0.03, EITHER(0x1.2533fe68fd3d3p-31, 0x1.65e9f6p-18), 0.0);
    TEST_ASSERT_EQUAL_INT(1, model_of(v).dof);
    v.wheel[1].axle_rad *= 1 - LACONIC_EPSILON / 2;
    ASSERT_REFUSED(LACONIC_STRAIGHT_ONLY, LACONIC_FIELD_WHEEL_KIND, 2, laconic_prepare(&model, &v, &why), why);
}

/* The root of their ratio is a hundredth of what the last digit is of 1: just too much. */
static void inertias_that_leave_a_hundredth_of_the_digits_are_refused(void) {
    laconic_vehicle v = bare_body();
    laconic_model model;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.0, 0.0, 0.0);
    v.wheel_inertia_kgm2 = EITHER(REAL(0x1.4f8b588e368f1p+85), REAL(0x1.4f8b58p+27));
    ASSERT_REFUSED(LACONIC_ILL_CONDITIONED, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    TEST_ASSERT_TRUE(LACONIC_EPSILON * laconic_root(why.value) == REAL(0.01));
    v.wheel_inertia_kgm2 *= 1 - 8 * LACONIC_EPSILON;
    ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &v, &why));
}

/* A body of 0.3 of the range's root by its mass, which counts once more as that of M R², and 0.8 of it by one number
 * more: each alone would be taken, both are too much. */
static void numbers_that_leave_the_range_together_are_refused_and_do_not_cancel(void) {
    const double root = EITHER(1.3407807929942596e154, 1.8446743e19);
    for (int k = 0; k < 4; k++) {
        laconic_vehicle v = bare_body();
        laconic_model model;
        v.wheel_radius_m = 1;
        v.wheel_inertia_kgm2 = 0;
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.0, 0.0, 0.0, PI / 2);
        laconic_real *const number[4] = {&v.motor_gain_Nm_per_V, &v.motor_damping_Nms, &v.com_x_m, &v.com_y_m};
        if (k >= 2) v.wheel_count = 0; /* a place is seen from no wheel */
        *number[k] = REAL(0.8 * root);
        v.mass_kg = v.yaw_inertia_kgm2 = REAL(0.05 * root);
        ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &v, &why));
        v.mass_kg = v.yaw_inertia_kgm2 = REAL(0.3 * root);
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
        *number[k] = 0;
        ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &v, &why));
    }
}

/* Sums that fill it: their order is one of the bits'. The largest number that is taken, and the next one. */
static void the_end_of_the_range_is_there_to_the_last_bit(void) {
    for (int k = 0; k < 2; k++) {
        laconic_vehicle v = bare_body();
        laconic_model model;
        v.mass_kg = v.wheel_radius_m = v.yaw_inertia_kgm2 = 1;
        v.wheel_inertia_kgm2 = 0;
        laconic_real *const last = k == 0 ? &v.com_x_m : &v.motor_gain_Nm_per_V;
        if (k == 0) { /* both coordinates and the square of 1/Λ */
            v.com_y_m = EITHER(REAL(0x1.bffffffffffffp+509), REAL(0x1.bffffep+61));
            v.yaw_inertia_kgm2 = EITHER(REAL(0x1.7d05f417d05f6p-511), REAL(0x1.7d05f6p-63));
            *last = EITHER(REAL(0x1.c00000000000dp+508), REAL(0x1.bffffap+60));
        } else { /* inertia, damping and gain of a wheel that is large, so that it turns slowly */
            add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.0, 0.0, 0.0, PI / 2);
            v.wheel[0].own_radius_m = EITHER(REAL(1e66), REAL(1e8));
            v.mass_kg = EITHER(REAL(1.25), REAL(0.5));
            v.wheel_inertia_kgm2 = EITHER(REAL(0x1.b7fffffffffffp+509), REAL(0x1.6ffffep+61));
            v.motor_damping_Nms = EITHER(REAL(0x1.3ffffffffffffp+508), REAL(0x1.3ffffep+60));
            *last = EITHER(REAL(0x1.9238e38e38e37p+510), REAL(0x1.faaaa8p+61));
        }
        ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &v, &why));
        *last += *last * (LACONIC_EPSILON / 2);
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    }
}

/* Squares beside which their root still counts: of w, and of a rotation that damping and inertia fill, too. */
static void in_single_roots_beside_squares_count_at_the_end_of_the_range(void) {
    const laconic_real known[2][2] = {{REAL(0x1.249262p-42), REAL(0x1.666656p+63)},
                                      {REAL(0x1.249266p-42), REAL(0x1.66665ap+63)}};
    for (int k = 0; k < 3 && !IN_DOUBLE; k++) { /* in double they are less than the last digit */
        laconic_vehicle v = bare_body();
        laconic_model model;
        v.mass_kg = v.wheel_radius_m = 1;
        laconic_real *const last = k < 2 ? &v.com_x_m : &v.motor_gain_Nm_per_V;
        if (k < 2) {
            v.yaw_inertia_kgm2 = known[k][0];
            v.com_y_m = REAL(0x1.333332p+62);
            *last = known[k][1];
        } else {
            v.yaw_inertia_kgm2 = REAL(0x1.c71c76p-124);
            v.wheel_inertia_kgm2 = REAL(0x1.47ae14p-7);
            v.motor_damping_Nms = REAL(0x1.51eb84p+55);
            add_wheel(&v, LACONIC_WHEEL_FIXED, 0x1.b8874p-39, 0.0, 0.0, 0.0);
            add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0x1.b8874p-39, PI / 2, 0.0);
            *last = REAL(0x1.195c2p+61);
        }
        ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &v, &why));
        *last *= 1 + LACONIC_EPSILON;
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    }
}

/* The largest number but one in single, whose last place is twice what the rest of a sum is near to. */
#define LARGEST REAL(0x1p64 - 0x1p40)

/* Axes that are rotated twice have rows that are the roots of inertias. Each of the three decides here. */
static void in_single_roots_of_inertias_count_at_the_end_of_the_range(void) {
    static const double gain[] = {0x1.f3ffe8p+37, 0x1.f3ffeap+37};
    for (int beyond = 0; beyond < 2 && !IN_DOUBLE; beyond++) {
        laconic_vehicle v = bare_body();
        laconic_model model;
        v.mass_kg = LARGEST;
        v.wheel_radius_m = REAL(0x1p-32);
        v.yaw_inertia_kgm2 = 1;
        v.wheel_inertia_kgm2 = 0;
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0, 0, PI / 2, PI / 2);
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0x1p-32, 0, 0, PI / 2);
        add_wheel(&v, LACONIC_WHEEL_ROLLER, -0x1p-32, 0, 0, PI / 2);
        for (int i = 0; i < 3; i++) {
            v.wheel[i].own_inertia_kgm2 = REAL(0x1p32);
            v.wheel[i].own_motor_damping_Nms = REAL(1 + i);
        }
        v.wheel[0].own_motor_gain_Nm_per_V = REAL(gain[beyond]);
        ASSERT_STATUS(beyond ? LACONIC_OVERFLOW : LACONIC_OK, laconic_prepare(&model, &v, &why));
    }
}

/* w × g is not longer than w, and its last place is one of the mass. */
static void in_single_the_turn_of_w_counts_at_the_end_of_the_range(void) {
    static const double mass[] = {0x1.fe96e8p+38, 0x1.fe96eap+38};
    for (int beyond = 0; beyond < 2 && !IN_DOUBLE; beyond++) {
        laconic_vehicle v = bare_body();
        laconic_model model;
        v.mass_kg = REAL(mass[beyond]);
        v.wheel_radius_m = REAL(0x1p-20);
        v.yaw_inertia_kgm2 = REAL(0x1p-33);
        v.wheel_inertia_kgm2 = 0;
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0x1p-36, 0, 0, PI / 2);
        v.wheel[0].locked = true; /* so that its inertia is none of the motion's */
        v.wheel[0].own_inertia_kgm2 = LARGEST;
        ASSERT_STATUS(beyond ? LACONIC_OVERFLOW : LACONIC_OK, laconic_prepare(&model, &v, &why));
    }
}

/* The gain is the largest number that fits, scales or rates about half a place of it, and the others about half a place
 * of these: each of them decides there, and the order in which they are added. */
static void in_single_sizes_add_up_in_their_order_to_the_end_of_the_range(void) {
    static const struct {
        double mass_kg, radius_m, yaw_inertia_kgm2, inertia_kgm2, gain, damping, wheel[3][3];
        laconic_status status;
    } cases[] = {{0x1.001802p-13,
                  1,
                  0x1.001802p-13,
                  0x1.c2b99cp-17,
                  0x1.556aaap+49,
                  0x1.7ded82p+23,
                  {{0, 1.75, 1}, {0.5, 1.5, 1.25}, {1.75, 1.5, 1}},
                  LACONIC_OK},
                 {0x1.ffffbep+38,
                  0x1p-20,
                  0x1.c28f5cp-1,
                  0x1.851e86p-3,
                  0x1.c71c48p+60,
                  0x1.052b4cp+12,
                  {{1.25, 0, 1}, {0.5, 1.5, 0}, {1, 0.5, 0.75}},
                  LACONIC_OVERFLOW},
                 {0x1.ffffbep+38,
                  0x1p-20,
                  0x1.ccccccp-1,
                  0x1.0a3d4ep-3,
                  0x1.c71c48p+60,
                  0x1.5df1a2p+11,
                  {{1.75, 1, 1.5}, {0, 1, 0.75}, {1.5, 0.5, 2.75}},
                  LACONIC_OVERFLOW},
                 {0x1.ffffbep+38,
                  0x1p-20,
                  0x1.ccccccp-1,
                  0x1.0a3d4ep-3,
                  0x1.c71c48p+60,
                  0x1.5df1ap+11,
                  {{1.75, 1, 1.5}, {0, 1, 0.75}, {1.5, 0.5, 2.75}},
                  LACONIC_OK}};
    for (size_t n = 0; n < sizeof cases / sizeof cases[0] && !IN_DOUBLE; n++) {
        laconic_vehicle v = bare_body();
        laconic_model model;
        v.mass_kg = REAL(cases[n].mass_kg);
        v.wheel_radius_m = REAL(cases[n].radius_m);
        v.yaw_inertia_kgm2 = REAL(cases[n].yaw_inertia_kgm2);
        v.wheel_inertia_kgm2 = REAL(cases[n].inertia_kgm2);
        v.motor_gain_Nm_per_V = REAL(cases[n].gain);
        v.motor_damping_Nms = REAL(cases[n].damping);
        for (int i = 0; i < 3; i++) {
            const double *at = cases[n].wheel[i], radius_m = cases[n].radius_m;
            add_wheel(&v, LACONIC_WHEEL_ROLLER, at[0] * radius_m, at[1] * radius_m, at[2], PI / 2);
        }
        ASSERT_STATUS(cases[n].status, laconic_prepare(&model, &v, &why));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(axes_are_the_same_without_damping_where_rows_hardly_are_numbers);
    RUN_TEST(columns_are_rotated_until_a_quarter_of_the_last_digit_is_left);
    RUN_TEST(axle_lines_that_differ_by_just_the_tolerance_count_once);
    RUN_TEST(axle_lines_that_meet_at_just_the_tolerance_leave_a_rotation);
    RUN_TEST(inertias_that_leave_a_hundredth_of_the_digits_are_refused);
    RUN_TEST(numbers_that_leave_the_range_together_are_refused_and_do_not_cancel);
    RUN_TEST(the_end_of_the_range_is_there_to_the_last_bit);
    RUN_TEST(in_single_roots_beside_squares_count_at_the_end_of_the_range);
    RUN_TEST(in_single_roots_of_inertias_count_at_the_end_of_the_range);
    RUN_TEST(in_single_the_turn_of_w_counts_at_the_end_of_the_range);
    RUN_TEST(in_single_sizes_add_up_in_their_order_to_the_end_of_the_range);
    return UNITY_END();
}
