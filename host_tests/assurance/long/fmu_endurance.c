/* fmu_endurance cycles N    makes and frees N instances of each kind, with steps and saved states in between; prints
 *                           the bytes that are allocated after the first cycle and the last, which must be the same
 * fmu_endurance threads N   N threads, each with its own instances; all must end with the same bits
 *
 * Built with sanitizers, which find leaks and races. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "fmi3Functions.h"

#include "instance.h"

enum { X = 38, VOLTAGE = 31, MOST_THREADS = 64 };

static void must(int good, const char *what) {
    if (good) return;
    fprintf(stderr, "fmu_endurance: %s failed\n", what);
    exit(1);
}

static void log_2(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String category, fmi2String text,
                  ...) {
    (void)e;
    fprintf(stderr, "%s: %d %s: %s\n", name, (int)status, category, text);
}

static double drive_2(fmi2Type kind, int steps) {
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL};
    const fmi2ValueReference voltage = VOLTAGE * 1024U + 1U, x = X;
    fmi2Component c = fmi2Instantiate("one", kind, fmu_token_2, NULL, &callbacks, fmi2False, fmi2False);
    fmi2FMUstate state = NULL, copy = NULL;
    fmi2Byte *bytes;
    size_t size;
    double value = 4.0;
    must(c != NULL, "fmi2Instantiate");
    must(fmi2EnterInitializationMode(c) == fmi2OK && fmi2ExitInitializationMode(c) == fmi2OK, "initialization");
    must(fmi2SetReal(c, &voltage, 1, &value) == fmi2OK, "fmi2SetReal");
    if (kind == fmi2CoSimulation)
        for (int k = 0; k < steps; k++) must(fmi2DoStep(c, k * 0.01, 0.01, fmi2True) == fmi2OK, "fmi2DoStep");
    must(fmi2GetFMUstate(c, &state) == fmi2OK && fmi2SerializedFMUstateSize(c, state, &size) == fmi2OK, "state");
    bytes = malloc(size);
    must(bytes != NULL && fmi2SerializeFMUstate(c, state, bytes, size) == fmi2OK, "fmi2SerializeFMUstate");
    must(fmi2DeSerializeFMUstate(c, bytes, size, &copy) == fmi2OK && fmi2SetFMUstate(c, copy) == fmi2OK, "restore");
    free(bytes);
    fmi2FreeFMUstate(c, &state);
    fmi2FreeFMUstate(c, &copy);
    must(fmi2GetReal(c, &x, 1, &value) == fmi2OK, "fmi2GetReal");
    fmi2FreeInstance(c);
    return value;
}

static void log_3(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String text) {
    (void)e;
    fprintf(stderr, "%d %s: %s\n", (int)status, category, text);
}

static double drive_3(bool exchange, int steps) {
    const fmi3ValueReference voltage = VOLTAGE * 1024U + 1U, x = X;
    fmi3Instance c = exchange ? fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, false, NULL, log_3)
                              : fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, false, false, false, NULL,
                                                            0, NULL, log_3, NULL);
    fmi3FMUState state = NULL;
    fmi3Boolean b[3];
    double value = 4.0, time;
    must(c != NULL, "fmi3Instantiate");
    must(fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0) == fmi3OK &&
             fmi3ExitInitializationMode(c) == fmi3OK,
         "initialization");
    must(fmi3SetFloat64(c, &voltage, 1, &value, 1) == fmi3OK, "fmi3SetFloat64");
    for (int k = 0; k < steps && !exchange; k++)
        must(fmi3DoStep(c, k * 0.01, 0.01, true, &b[0], &b[1], &b[2], &time) == fmi3OK, "fmi3DoStep");
    must(fmi3GetFMUState(c, &state) == fmi3OK && fmi3SetFMUState(c, state) == fmi3OK &&
             fmi3FreeFMUState(c, &state) == fmi3OK,
         "state");
    must(fmi3GetFloat64(c, &x, 1, &value, 1) == fmi3OK, "fmi3GetFloat64");
    fmi3FreeInstance(c);
    return value;
}

static void *work(void *result) {
    double *x = result;
    x[0] = drive_2(fmi2CoSimulation, 2000);
    x[1] = drive_3(false, 2000);
    drive_2(fmi2ModelExchange, 0);
    drive_3(true, 0);
    return NULL;
}

static void run_threads(int count) {
    pthread_t thread[MOST_THREADS];
    double x[MOST_THREADS][2];
    must(count > 0 && count <= MOST_THREADS, "the number of threads");
    for (int k = 0; k < count; k++) must(pthread_create(&thread[k], NULL, work, x[k]) == 0, "pthread_create");
    for (int k = 0; k < count; k++) must(pthread_join(thread[k], NULL) == 0, "pthread_join");
    for (int k = 0; k < count; k++) must(memcmp(x[k], x[0], sizeof x[0]) == 0 && x[k][0] == x[k][1], "equality");
}

/* Of the run-time of the address sanitizer. */
size_t __sanitizer_get_current_allocated_bytes(void) __attribute__((weak));

static size_t allocated_bytes(void) {
    return __sanitizer_get_current_allocated_bytes == NULL ? 0 : __sanitizer_get_current_allocated_bytes();
}

static int run_cycles(int count) {
    size_t first = 0;
    for (int k = 0; k < count; k++) {
        drive_2(fmi2CoSimulation, 3);
        drive_2(fmi2ModelExchange, 0);
        drive_3(false, 3);
        drive_3(true, 0);
        if (k == 0) first = allocated_bytes();
        if ((k + 1) % 1000 == 0) fprintf(stderr, "%d\n", k + 1); /* for whoever waits */
    }
    const size_t last = allocated_bytes();
    printf("%d cycles of 4 instances, %zu B after the first, %zu B after the last\n", count, first, last);
    must(first == last, "constant memory");
    return 0;
}

int main(int argc, char **argv) {
    const int count = argc == 3 ? atoi(argv[2]) : 0;
    if (count <= 0) {
        fprintf(stderr, "usage: fmu_endurance cycles|threads N\n");
        return 2;
    }
    if (strcmp(argv[1], "threads") == 0) {
        run_threads(count);
        return 0;
    }
    return run_cycles(count);
}
