/* Prints the bits that a run through the FMI 3 functions ends with, for every method: compared between platforms. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"

#include "instance.h"

enum { METHOD = 29, VOLTAGE = 31, WORLD_FORCE = 35, STEPS = 3000, OUTPUTS = 14 };

static void log_3(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String text) {
    (void)e;
    fprintf(stderr, "%d %s: %s\n", (int)status, category, text);
}

static void must(fmi3Status status) {
    if (status != fmi3OK) exit(1);
}

static void run(int64_t method) {
    static const fmi3ValueReference method_reference = METHOD, voltage = VOLTAGE, force = WORLD_FORCE;
    static const fmi3ValueReference out[] = {37, 38, 39, 40, 41, 48, 49}; /* ν, x, y, θ, χ, χ', torque */
    fmi3Instance c = fmi3InstantiateCoSimulation("bits", fmu_token_3, NULL, false, false, false, false, NULL, 0, NULL, log_3,
                                                 NULL);
    fmi3Boolean b[3];
    double values[18], volts[4] = {0, 0, 0, 0}, push[2] = {3.0, -2.0}, time;
    int k, i;
    if (c == NULL) exit(1);
    must(fmi3SetInt64(c, &method_reference, 1, &method, 1));
    must(fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0));
    must(fmi3ExitInitializationMode(c));
    must(fmi3SetFloat64(c, &force, 1, push, 2));
    for (k = 0; k < STEPS; k++) {
        for (i = 0; i < 4; i++) volts[i] = (double)((k * (i + 3)) % 17) - 8.0;
        must(fmi3SetFloat64(c, &voltage, 1, volts, 4));
        must(fmi3DoStep(c, k * 0.01, 0.01, true, &b[0], &b[1], &b[2], &time));
    }
    must(fmi3GetFloat64(c, out, 7, values, 18));
    for (i = 0; i < 18; i++) {
        unsigned long long bits;
        memcpy(&bits, &values[i], sizeof bits);
        printf("%016llx%c", bits, i == 17 ? '\n' : ' ');
    }
    fmi3FreeInstance(c);
}

int main(void) {
    int64_t method;
    for (method = 0; method < LACONIC_METHOD_COUNT; method++) run(method);
    return 0;
}
