/* count_estimate METHOD WINDOW STEPS: a mecanum carriage with its input held, watched by an error estimate with windows
 * of up to WINDOW steps (0: not watched), so that instructions can be counted. The difference of two counts is the
 * cost. */
#include "laconic/estimate.h"
#include "vehicles.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
    laconic_vehicle vehicle = with_motors(mecanum());
    const laconic_start start = start_with(1, 2, 3);
    const laconic_method *method = laconic_method_by_name(argc == 4 ? argv[1] : "auto");
    const int32_t window = argc == 4 ? (int32_t)atoi(argv[2]) : LACONIC_ESTIMATE_USUAL;
    const uint64_t steps = argc == 4 ? strtoul(argv[3], NULL, 10) : 10;
    laconic_input input = no_input();
    laconic_plant plant;
    laconic_estimate estimate;
    laconic_errors errors;
    laconic_status status;
    input.voltage_V[0] = input.voltage_V[1] = REAL(1);
    if (laconic_plant_start(&plant, &vehicle, method, REAL(0.001), &start, NULL) != LACONIC_OK) return 1;
    if (laconic_estimate_start(&estimate, &plant, window > 0 ? window : 1, laconic_finer_method(&plant), NULL) !=
        LACONIC_OK)
        return 1;
    status = window > 0 ? laconic_estimate_run(&estimate, &plant, &input, steps, NULL)
                        : laconic_plant_run(&plant, &input, steps, NULL);
    laconic_estimate_read(&errors, &estimate, &plant);
    printf("%llu steps, place off by %g m\n", (unsigned long long)plant.steps, (double)errors.now.place_m);
    return status != LACONIC_OK;
}
