/* What the glue costs: set 4 voltages, doStep, get ν, x, y and heading through the FMI functions, beside the bare core
 * step and beside a minimal FMU. All loops take turns; the least time of each counts. Prints JSON with --json. With
 * --count one loop alone takes so many steps: its instructions are (I(2n) − I(n))/n.
 *
 *     fmu_overhead fmi2/Laconic.so fmi3/Laconic.so libminimal.so [--json | --count LOOP STEPS] */
#define _POSIX_C_SOURCE 200809L
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fmi2Functions.h"
#include "fmi3Functions.h"

#include "instance.h"

enum { WARM = 2000, STEPS = 20000, ROUNDS = 200, FRICTION = 11, VOLTAGE = 31, NU = 37, X = 38 };
#define STEP_S 0.01
#define METHOD_RK4 1

static const double volts[4] = {2.0, 3.0, 2.5, 2.0};
static const double unwatched = 0.0; /* no friction coefficient: no reactions are computed at every step */
static double sink;

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void *symbol(void *library, const char *name) {
    void *found = dlsym(library, name);
    if (found == NULL) {
        fprintf(stderr, "fmu_overhead: %s is missing\n", name);
        exit(2);
    }
    return found;
}

static void *load(const char *path) {
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        fprintf(stderr, "fmu_overhead: %s\n", dlerror());
        exit(2);
    }
    return library;
}

/* ISO C has no cast from data to function pointers. */
#define LOAD(target, library, name) \
    do { \
        void *found = symbol(library, name); \
        memcpy(&(target), &found, sizeof found); \
    } while (0)

static void must(int status, const char *what) {
    if (status == 0) return;
    fprintf(stderr, "fmu_overhead: %s: status %d\n", what, status);
    exit(2);
}

/* --------------------------------------------------------------------------------------- FMI 2 -- */

static struct {
    fmi2SetRealTYPE *set;
    fmi2GetRealTYPE *get;
    fmi2DoStepTYPE *step;
    fmi2Component c;
} two;

static void logger_2(fmi2ComponentEnvironment e, fmi2String name, fmi2Status s, fmi2String category, fmi2String text,
                     ...) {
    (void)e;
    fprintf(stderr, "%s %d %s %s\n", name, (int)s, category, text);
}

static void start_2(const char *path) {
    static const fmi2CallbackFunctions callbacks = {logger_2, calloc, free, NULL, NULL};
    const fmi2ValueReference method = 29, friction = FRICTION;
    const fmi2Integer number = METHOD_RK4;
    void *library = load(path);
    fmi2InstantiateTYPE *instantiate;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *leave;
    fmi2SetIntegerTYPE *set_integer;
    LOAD(instantiate, library, "fmi2Instantiate");
    LOAD(enter, library, "fmi2EnterInitializationMode");
    LOAD(leave, library, "fmi2ExitInitializationMode");
    LOAD(set_integer, library, "fmi2SetInteger");
    LOAD(two.set, library, "fmi2SetReal");
    LOAD(two.get, library, "fmi2GetReal");
    LOAD(two.step, library, "fmi2DoStep");
    two.c = instantiate("bench", fmi2CoSimulation, fmu_token_2, NULL, &callbacks, fmi2False, fmi2False);
    must(two.c == NULL, "fmi2Instantiate");
    must((int)set_integer(two.c, &method, 1, &number), "fmi2SetInteger");
    must((int)two.set(two.c, &friction, 1, &unwatched), "fmi2SetReal");
    must((int)enter(two.c), "fmi2EnterInitializationMode");
    must((int)leave(two.c), "fmi2ExitInitializationMode");
}

static void run_2(long first, long count) {
    static const fmi2ValueReference in[4] = {VOLTAGE * 1024U + 1U, VOLTAGE * 1024U + 2U, VOLTAGE * 1024U + 3U,
                                             VOLTAGE * 1024U + 4U};
    static const fmi2ValueReference out[6] = {NU * 1024U + 1U, NU * 1024U + 2U, NU * 1024U + 3U, X, X + 1, X + 2};
    double values[6];
    long k;
    for (k = first; k < first + count; k++) {
        two.set(two.c, in, 4, volts);
        must((int)two.step(two.c, (double)k * STEP_S, STEP_S, fmi2True), "fmi2DoStep");
        two.get(two.c, out, 6, values);
        sink += values[0];
    }
}

/* --------------------------------------------------------------------------------------- FMI 3 -- */

static struct {
    fmi3SetFloat64TYPE *set;
    fmi3GetFloat64TYPE *get;
    fmi3DoStepTYPE *step;
    fmi3Instance c;
} three;

static void logger_3(fmi3InstanceEnvironment e, fmi3Status s, fmi3String category, fmi3String text) {
    (void)e;
    fprintf(stderr, "%d %s %s\n", (int)s, category, text);
}

static void start_3(const char *path) {
    const fmi3ValueReference method = 29, friction = FRICTION;
    const fmi3Int64 number = METHOD_RK4;
    void *library = load(path);
    fmi3InstantiateCoSimulationTYPE *instantiate;
    fmi3EnterInitializationModeTYPE *enter;
    fmi3ExitInitializationModeTYPE *leave;
    fmi3SetInt64TYPE *set_integer;
    LOAD(instantiate, library, "fmi3InstantiateCoSimulation");
    LOAD(enter, library, "fmi3EnterInitializationMode");
    LOAD(leave, library, "fmi3ExitInitializationMode");
    LOAD(set_integer, library, "fmi3SetInt64");
    LOAD(three.set, library, "fmi3SetFloat64");
    LOAD(three.get, library, "fmi3GetFloat64");
    LOAD(three.step, library, "fmi3DoStep");
    three.c = instantiate("bench", fmu_token_3, NULL, false, false, false, false, NULL, 0, NULL, logger_3, NULL);
    must(three.c == NULL, "fmi3Instantiate");
    must((int)set_integer(three.c, &method, 1, &number, 1), "fmi3SetInt64");
    must((int)three.set(three.c, &friction, 1, &unwatched, 1), "fmi3SetFloat64");
    must((int)enter(three.c, false, 0.0, 0.0, false, 0.0), "fmi3EnterInitializationMode");
    must((int)leave(three.c), "fmi3ExitInitializationMode");
}

static void run_3(long first, long count) {
    static const fmi3ValueReference in[1] = {VOLTAGE}, out[4] = {NU, X, X + 1, X + 2};
    fmi3Boolean flags[3];
    double values[6], time;
    long k;
    for (k = first; k < first + count; k++) {
        three.set(three.c, in, 1, volts, 4);
        must((int)three.step(three.c, (double)k * STEP_S, STEP_S, true, &flags[0], &flags[1], &flags[2], &time),
             "fmi3DoStep");
        three.get(three.c, out, 4, values, 6);
        sink += values[0];
    }
}

/* ------------------------------------------------------------------------------ minimal FMU, core -- */

static struct {
    int (*set)(void *, const uint32_t *, size_t, const double *, size_t);
    int (*get)(void *, const uint32_t *, size_t, double *, size_t);
    int (*step)(void *, double, double);
    void *c;
} least;

static void start_minimal(const char *path) {
    void *library = load(path);
    void *(*create)(void);
    LOAD(create, library, "minimal_create");
    LOAD(least.set, library, "minimal_set");
    LOAD(least.get, library, "minimal_get");
    LOAD(least.step, library, "minimal_step");
    least.c = create();
}

static void run_minimal(long first, long count) {
    static const uint32_t references[6] = {0, 1, 2, 3, 4, 5};
    double values[6];
    long k;
    for (k = first; k < first + count; k++) {
        least.set(least.c, references, 4, volts, 4);
        must(least.step(least.c, (double)k * STEP_S, STEP_S), "minimal_step");
        least.get(least.c, references, 6, values, 6);
        sink += values[0];
    }
}

static laconic_plant plant;
static laconic_input input;

static void start_core(void) {
    const laconic_start start = {0};
    const fmu_start_value *value = fmu_built_in_starts;
    fmu_instance *instance = calloc(1, sizeof *instance);
    for (size_t k = 0; k < fmu_built_in_start_count; k++)
        if (!fmu_set_start_value(instance, value[k].reference, value[k].value)) exit(2);
    must((int)laconic_plant_start(&plant, &instance->model.vehicle, &laconic_rk4, STEP_S, &start, NULL), "plant_start");
    free(instance);
    memcpy(input.voltage_V, volts, sizeof volts);
}

static void run_core(long first, long count) {
    long k;
    for (k = first; k < first + count; k++) {
        must((int)laconic_step(&plant.model, &plant.integrator, &plant.state, &input), "laconic_step");
        sink += plant.state.x_m.value;
    }
}

static void run_core_with_outputs(long first, long count) {
    laconic_pose pose;
    double nu[3];
    long k;
    for (k = first; k < first + count; k++) {
        must((int)laconic_step(&plant.model, &plant.integrator, &plant.state, &input), "laconic_step");
        laconic_nu(&plant.model, &plant.state, nu);
        laconic_pose_of(&pose, &plant.model, &plant.state);
        sink += nu[0] + pose.x_m;
    }
}

/* --------------------------------------------------------------------------------------- results -- */

typedef struct contender {
    const char *name;
    void (*run)(long first, long count);
    double least_ns;
    long at;
} contender;

static int count_one(const contender all[], size_t count, const char *name, const char *steps) {
    for (size_t i = 0; i < count; i++)
        if (strcmp(all[i].name, name) == 0) {
            all[i].run(0, strtol(steps, NULL, 10));
            return 0;
        }
    fprintf(stderr, "fmu_overhead: there is no loop %s\n", name);
    return 2;
}

int main(int argc, char **argv) {
    contender all[] = {{"core", run_core, 1e99, 0},
                       {"core_with_outputs", run_core_with_outputs, 1e99, 0},
                       {"fmi2", run_2, 1e99, 0},
                       {"fmi3", run_3, 1e99, 0},
                       {"minimal", run_minimal, 1e99, 0}};
    const size_t count = sizeof all / sizeof all[0];
    if (argc < 4) {
        fprintf(stderr, "usage: fmu_overhead FMI2.so FMI3.so MINIMAL.so [--json | --count LOOP STEPS]\n");
        return 2;
    }
    start_2(argv[1]);
    start_3(argv[2]);
    start_minimal(argv[3]);
    start_core();
    if (argc > 6 && strcmp(argv[4], "--count") == 0) return count_one(all, count, argv[5], argv[6]);
    for (int round = 0; round < ROUNDS; round++)
        for (size_t i = 0; i < count; i++) {
            const long steps = round == 0 ? WARM : STEPS / 20;
            const double start = now_ns();
            all[i].run(all[i].at, steps);
            const double each = (now_ns() - start) / (double)steps;
            all[i].at += steps;
            if (each < all[i].least_ns) all[i].least_ns = each;
        }
    if (argc > 4)
        printf("{\"core_ns\": %.1f, \"core_with_outputs_ns\": %.1f, \"fmi2_ns\": %.1f, \"fmi3_ns\": %.1f, "
               "\"minimal_ns\": %.1f, \"fmi2_glue_ns\": %.1f, \"fmi3_glue_ns\": %.1f}\n",
               all[0].least_ns, all[1].least_ns, all[2].least_ns, all[3].least_ns, all[4].least_ns,
               all[2].least_ns - all[0].least_ns, all[3].least_ns - all[0].least_ns);
    else
        for (size_t i = 0; i < count; i++)
            printf("%-20s %7.1f ns a step, %7.1f beyond the bare core step\n", all[i].name, all[i].least_ns,
                   all[i].least_ns - all[0].least_ns);
    return sink == 0.12345 ? 1 : 0;
}
