/* Tests that the core's own functions give, bit for bit, what they gave in the version before: root, exponential, φ,
 * directions, polynomials, headings, noise, encoders, angles and counts of steps. test_elementary.c, test_heading.c and
 * test_noise.c compare them with the host's library. */
#include "elementary.h"
#include "friction_internals.h"
#include "heading.h"

#include "bits.h"

#define TAKE_ONE(number) \
    do { \
        const laconic_real one = (number); \
        TAKE(one); \
    } while (0)

static void take_whole(uint64_t whole) {
    for (int k = 0; k < 8; k++) hash = (hash ^ ((whole >> (8 * k)) & 255U)) * 1099511628211U;
}

static void take_direction(direction d) {
    TAKE_ONE(d.cosine);
    TAKE_ONE(d.sine);
}

static void roots_and_exponentials(void) {
    const laconic_real odd[8] = {0,        -1,          REAL(4), REAL(0.25), LACONIC_REAL_MAX, LACONIC_REAL_MIN,
                                 INFINITE, NOT_A_NUMBER};
    begin();
    for (int k = 0; k < 8; k++) {
        TAKE_ONE(laconic_root(odd[k]));
        TAKE_ONE(laconic_decaying_exponential(odd[k]));
    }
    laconic_real x = REAL(1e-30);
    for (int k = 0; k < 600; k++) {
        TAKE_ONE(laconic_root(x));
        x *= REAL(1.27);
    }
    for (int k = 0; k < 2000; k++) TAKE_ONE(laconic_decaying_exponential(REAL(0.4) * REAL(k)));
    for (int k = 0; k < 300; k++) TAKE_ONE(laconic_decaying_exponential(REAL(0.01) * REAL(k)));
    expect(EITHER(0x0b7d4b3dafe73724U, 0x23c8178edad95332U));
}

static void exponential_integrals(void) {
    laconic_real a = REAL(1e-9);
    begin();
    for (int k = 0; k < 500; k++) {
        laconic_real phi[6] = {0};
        laconic_phi(phi, k == 0 ? 0 : a);
        TAKE(phi);
        a *= REAL(1.06);
    }
    expect(EITHER(0xd8267f050eb84b84U, 0x09636d23b6618340U));
}

static void directions_of_angles(void) {
    begin();
    for (int k = -2000; k < 2000; k++) take_direction(laconic_direction_of_angle(REAL(0.0123) * REAL(k)));
    laconic_real angle = REAL(0.7);
    for (int k = 0; k < 200; k++) {
        take_direction(laconic_direction_of_angle(angle));
        take_whole(laconic_binary_angle_of(angle));
        take_whole(laconic_binary_angle_of(-angle));
        TAKE_ONE(laconic_angle_wrapped(angle));
        TAKE_ONE(laconic_angle_wrapped(-angle));
        angle *= REAL(1.3);
    }
    TAKE_ONE(laconic_angle_wrapped(REAL(3.14159265358979323846)));
    TAKE_ONE(laconic_angle_wrapped(-REAL(3.14159265358979323846)));
    TAKE_ONE(laconic_angle_wrapped(INFINITE));
    laconic_binary_angle binary = 0;
    for (int k = 0; k < 1000; k++) {
        take_direction(laconic_direction_of_binary_angle(binary));
        binary = (laconic_binary_angle)(binary + (laconic_binary_angle)EITHER(0x0123456789abcdefU, 0x01234567U));
    }
    expect(EITHER(0x09dc2127f2f56c45U, 0x4046552db638a751U));
}

static void polynomials(void) {
    begin();
    for (int k = -64; k <= 64; k++) {
        const laconic_real x = REAL(0.0123) * REAL(k), z = x * x, small = REAL(0.015625) / 64 * REAL(k);
        TAKE_ONE(poly_sin(x, z));
        TAKE_ONE(poly_cos(z));
        TAKE_ONE(poly_sinc(small));
        TAKE_ONE(poly_j1(small));
        TAKE_ONE(poly_tangent(small));
    }
    expect(EITHER(0x4cdd2d3e61e40392U, 0xd4675b5241be272aU));
}

static void headings(void) {
    laconic_heading heading = {0, 0, 0};
    begin();
    laconic_real by = REAL(1e-6);
    for (int k = 0; k < 300; k++) {
        take_whole(heading_advance(&heading, k % 3 == 2 ? -REAL(1.7) * by : by));
        take_whole((uint64_t)heading.turns);
        take_whole(heading.fraction);
        TAKE_ONE(heading.rest);
        TAKE_ONE(heading_wrapped(&heading));
        TAKE_ONE(heading_unwrapped(&heading));
        by *= REAL(1.1);
    }
    expect(EITHER(0x21e10d625933362bU, 0xbfa24105a2810b3dU));
}

static void noise(void) {
    begin();
    for (uint64_t k = 0; k < 500; k++) {
        laconic_real pair[2];
        laconic_normal_pair(pair, k / 7 * 0x9e3779b97f4a7c15U, (uint32_t)(k % 7), k * k * k);
        TAKE(pair);
    }
    expect(EITHER(0x164152490ebcb271U, 0xb5f9d60448d4bba5U));
}

static void encoders(void) {
    begin();
    for (int32_t number = 0; number < 6; number++) {
        const laconic_encoder_settings settings = {1 + 777 * number, REAL(number == 2 ? 0 : 2.5 - number)};
        laconic_encoder encoder = {0, 0};
        laconic_real turned = REAL(0.001);
        for (int k = 0; k < 80; k++) {
            take_whole(laconic_encoder_turn(&encoder, &settings, k % 4 == 3 ? -3 * turned : turned));
            take_whole((uint64_t)encoder.count);
            TAKE_ONE(encoder.rest);
            take_whole((uint64_t)laconic_encoder_place(&encoder, settings.counts_per_turn));
            take_whole((uint64_t)laconic_encoder_turns(&encoder, settings.counts_per_turn));
            take_whole((uint64_t)laconic_encoder_shown(&encoder, 0));
            take_whole((uint64_t)laconic_encoder_shown(&encoder, 1000 + number));
            turned *= REAL(1.35);
        }
    }
    expect(EITHER(0x692e0d54be15e836U, 0x055523ee336489bfU));
}

static void counts_of_steps(void) {
    const double interval[8] = {0, -1, 1e-3, 0.01, 1, 3600, 1e12, 1e17};
    begin();
    for (int k = 0; k < 8; k++)
        for (int n = 0; n < 12; n++) {
            const double step = n == 0 ? 0 : n == 1 ? -1 : n == 2 ? (double)INFINITY : 1e-5 * n * n * n;
            uint64_t steps = 0;
            memset(&why, 0, sizeof why);
            take_whole((uint64_t)laconic_steps_in(interval[k] * (1 + 1e-9 * n), step, &steps, &why));
            take_refusal();
            take_whole(steps);
        }
    expect(EITHER(0xc054bf0899bdf561U, 0xa5aae9c35a064b49U));
}

static void quick_roots(void) {
    laconic_real x = LACONIC_REAL_MIN;
    begin();
    for (int k = 0; k < 2000; k++) {
        TAKE_ONE(quick_root(x));
        x *= EITHER(REAL(2.03), REAL(1.091));
    }
    expect(EITHER(0xa78314da3f5c44adU, 0xb8a2772ea584677eU));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(roots_and_exponentials);
    RUN_TEST(quick_roots);
    RUN_TEST(exponential_integrals);
    RUN_TEST(directions_of_angles);
    RUN_TEST(polynomials);
    RUN_TEST(headings);
    RUN_TEST(noise);
    RUN_TEST(encoders);
    RUN_TEST(counts_of_steps);
    return UNITY_END();
}
