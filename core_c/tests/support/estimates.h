/* A plant and its estimate, for the tests of estimates. */
#ifndef LACONIC_TEST_ESTIMATES_H
#define LACONIC_TEST_ESTIMATES_H

#include "laconic/estimate.h"
#include "methods.h"

static laconic_refusal why;

static inline laconic_plant plant_by(const laconic_method *method, const laconic_vehicle *vehicle, laconic_start start,
                                     double step) {
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, vehicle, method, REAL(step), &start, &why));
    return plant;
}

static inline laconic_estimate estimate_of(const laconic_plant *plant, int32_t most_steps) {
    laconic_estimate estimate;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, plant, most_steps, laconic_finer_method(plant), &why));
    return estimate;
}

static inline laconic_errors errors_now(const laconic_estimate *estimate, const laconic_plant *plant) {
    laconic_errors found;
    laconic_estimate_read(&found, estimate, plant);
    return found;
}

#endif
