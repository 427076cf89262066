/* Tests of divided_difference.h: (f(a) − f(b))/(a − b) of known functions, far apart and near. */
#include "divided_difference.h"

#include "check.h"

#define FUNCTIONS 3

static void powers(laconic_real value[], laconic_real h, laconic_real rate) {
    value[0] = rate;
    value[1] = rate * rate;
    value[2] = h * rate * rate * rate;
}

static void slopes(laconic_real value[], laconic_real h, laconic_real rate) {
    value[0] = 1;
    value[1] = 2 * rate;
    value[2] = 3 * h * rate * rate;
}

/* Of a cube it is a² + a b + b². What stood there before does not count; the number behind the last is left alone. */
static void check_at(double h, double a, double b) {
    laconic_real found[FUNCTIONS + 1];
    for (int k = 0; k <= FUNCTIONS; k++) found[k] = NOT_A_NUMBER;
    divided_difference_of(found, FUNCTIONS, powers, slopes, REAL(h), REAL(a), REAL(b));
    ASSERT_NEAR(8 * ROUNDING, 1, found[0]);
    ASSERT_NEAR(8 * ROUNDING * (a + b), a + b, found[1]);
    ASSERT_NEAR(8 * ROUNDING * h * (a + b) * (a + b), h * (a * a + a * b + b * b), found[2]);
    TEST_ASSERT_TRUE(found[FUNCTIONS] != found[FUNCTIONS]);
}

static void rates_far_apart_have_the_quotient(void) {
    check_at(1, 5, 2);
    check_at(1, 2, 5);
    check_at(0.125, 1, 40);
}

static void near_and_equal_rates_have_the_mean_of_the_slope(void) {
    check_at(0.5, 5, 4);
    check_at(0.5, 4, 5);
    check_at(2, 3, 3);
    check_at(1, 3, 2); /* just near */
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(rates_far_apart_have_the_quotient);
    RUN_TEST(near_and_equal_rates_have_the_mean_of_the_slope);
    return UNITY_END();
}
