/* Tests of noise.c: the deviates are normal, independent, and a function of seed, stream and index alone. */
#include "check.h"

#define PAIRS 100000
#define DEVIATES (2 * PAIRS)

static laconic_real deviate[DEVIATES];

static void draw(uint64_t seed, uint32_t stream) {
    for (int k = 0; k < PAIRS; k++) laconic_normal_pair(&deviate[2 * k], seed, stream, (uint64_t)k);
}

/* Of the algorithm, in 40 digits. */
static void the_deviates_are_those_of_an_independent_computation(void) {
    static const struct {
        uint64_t seed;
        uint32_t stream;
        uint64_t index;
        double pair[2];
    } known[] = {
        {0, 0, 0, {-0.1766018926540237253, 1.462162844123599351}},
        {0, 0, 1, {-1.6021330001690335355, 0.20066267715082806541}},
        {0, 1, 0, {1.0821993744951434107, 2.9502102345625278839}},
        {1, 0, 0, {-1.1555550284866270317, 0.58301474149137348203}},
        {12345, 1, UINT64_C(1000000000000), {0.17935178274646716135, 0.31527301537846285905}},
        {3, 0, UINT64_C(3651683935388646773), {6.9989972334352838299, -6.3037192861070711446}}, /* its share is 0 */
        {0, 0, UINT64_C(73309687144073641), {8.1411145491259408851, 4.4997631529166852893}},    /* and here 3 of 2^64 */
        {UINT64_C(4294967295), 0, UINT64_C(18446744073709551613), {1.2976304681674344532, 1.576964164913850127}}};
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++) {
        laconic_real pair[2];
        laconic_normal_pair(pair, known[k].seed, known[k].stream, known[k].index);
        ASSERT_NEAR(4 * ROUNDING, known[k].pair[0], pair[0]);
        ASSERT_NEAR(4 * ROUNDING, known[k].pair[1], pair[1]);
    }
}

/* Where the logarithm rounds otherwise once its series has one more term, or begins with another number than 0. */
static void some_deviates_are_the_same_to_the_last_bit(void) {
    static const struct {
        uint64_t index;
        double pair[2], in_single[2];
    } known[] = {{871, {-0x1.fd2761a318dp-2, 0x1.5672786a9f244p-1}, {-0x1.fd2764p-2, 0x1.567276p-1}},
                 {1132, {-0x1.8c8ff66c8cea4p-1, -0x1.3d13551dab563p-2}, {-0x1.8c8ff8p-1, -0x1.3d1356p-2}},
                 {6782, {-0x1.a2c735e3da90dp-1, 0x1.e580a49d12936p-3}, {-0x1.a2c738p-1, 0x1.e580a8p-3}},
                 {64659, {0x1.a7c187ca5f297p-1, 0x1.4978fba1274d8p-11}, {0x1.a7c188p-1, 0x1.4978f6p-11}}};
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++) {
        laconic_real pair[2];
        laconic_normal_pair(pair, 1, 0, known[k].index);
        for (int m = 0; m < 2; m++)
            TEST_ASSERT_TRUE((double)pair[m] == EITHER(known[k].pair[m], known[k].in_single[m]));
    }
}

/* Standard errors of n deviates: mean 1/√n, variance √(2/n), third moment √(15/n), fourth √(96/n). */
static void mean_variance_and_higher_moments_are_those_of_the_normal_distribution(void) {
    const double expected[4] = {0, 1, 0, 3}, error[4] = {1, sqrt(2), sqrt(15), sqrt(96)};
    double sum[4] = {0};
    draw(1, 0);
    for (int k = 0; k < DEVIATES; k++) {
        double power = 1;
        for (int m = 0; m < 4; m++) sum[m] += power *= (double)deviate[k];
    }
    for (int m = 0; m < 4; m++) ASSERT_NEAR(4 * error[m] / sqrt(DEVIATES), expected[m], sum[m] / DEVIATES);
}

/* How many lie beyond so many standard deviations, by the table of the normal distribution. */
static void tails_are_those_of_the_table(void) {
    static const struct {
        double beyond, share;
    } table[] = {{0.5, 0.6170750774519738},  {1, 0.31731050786291415},    {2, 0.04550026389635842},
                 {3, 0.0026997960632601866}, {3.5, 4.652581580710502e-4}, {4, 6.334248366623985e-5}};
    draw(2, 1);
    for (size_t t = 0; t < sizeof table / sizeof table[0]; t++) {
        int above = 0, below = 0;
        const double half = table[t].share / 2 * DEVIATES; /* on either side */
        for (int k = 0; k < DEVIATES; k++) {
            above += (double)deviate[k] > table[t].beyond;
            below += (double)deviate[k] < -table[t].beyond;
        }
        ASSERT_NEAR(4 * sqrt(half), half, above);
        ASSERT_NEAR(4 * sqrt(half), half, below);
    }
}

static double correlation(uint64_t seed, uint32_t stream, uint64_t later, int part) {
    double sum = 0;
    for (int k = 0; k < 20000; k++) {
        laconic_real one[2], other[2];
        laconic_normal_pair(one, 3, 0, (uint64_t)k);
        laconic_normal_pair(other, seed, stream, (uint64_t)k + later);
        sum += (double)one[0] * (double)other[part];
    }
    return sum / 20000;
}

static void neighbours_in_seed_stream_index_and_pair_are_independent(void) {
    const double within = 4 / sqrt(20000);
    ASSERT_NEAR(within, 0, correlation(3, 0, 0, 1));
    ASSERT_NEAR(within, 0, correlation(3, 0, 1, 0));
    ASSERT_NEAR(within, 0, correlation(3, 1, 0, 0));
    ASSERT_NEAR(within, 0, correlation(4, 0, 0, 0));
    ASSERT_NEAR(within, 0, correlation(4, 1, 1, 1));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_deviates_are_those_of_an_independent_computation);
    RUN_TEST(some_deviates_are_the_same_to_the_last_bit);
    RUN_TEST(mean_variance_and_higher_moments_are_those_of_the_normal_distribution);
    RUN_TEST(tails_are_those_of_the_table);
    RUN_TEST(neighbours_in_seed_stream_index_and_pair_are_independent);
    return UNITY_END();
}
