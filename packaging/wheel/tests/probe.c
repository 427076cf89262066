/* Uses what a wheel holds on a machine that may have no Python: its core library, or the binary of an FMU (FMI 2).
 *
 *     probe core LIBRARY                                          prints the result of laconic_self_test, 0: all right
 *     probe fmu LIBRARY GUID RESOURCES STOP_S STEP_S REFERENCE…   co-simulates, prints the reals' bits at the end */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

#ifdef _WIN32
#include <windows.h>
static void *open_library(const char *path) { return (void *)LoadLibraryA(path); }
static void *symbol(void *library, const char *name) { return (void *)GetProcAddress((HMODULE)library, name); }
#else
#include <dlfcn.h>
static void *open_library(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
static void *symbol(void *library, const char *name) { return dlsym(library, name); }
#endif

enum { MOST_REALS = 32 };

static void *needed(void *library, const char *name) {
    void *found = symbol(library, name);
    if (found == NULL) {
        fprintf(stderr, "probe: there is no function %s\n", name);
        exit(2);
    }
    return found;
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String message, ...) {
    va_list values;
    (void)environment, (void)instance, (void)status, (void)category;
    va_start(values, message);
    vfprintf(stderr, message, values);
    va_end(values);
    fputc('\n', stderr);
}

static int check_core(void *library) {
    int (*self_test)(void) = (int (*)(void))needed(library, "laconic_self_test");
    const int found = self_test();
    printf("%d\n", found);
    return found != 0;
}

static int run_fmu(void *library, char **given, int count) {
    const char *guid = given[0], *resources = given[1];
    const double stop_s = atof(given[2]), step_s = atof(given[3]);
    const long steps = (long)(stop_s / step_s + 0.5);
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    fmi2ValueReference reference[MOST_REALS];
    fmi2Real value[MOST_REALS];
    const int reals = count - 4;
    if (reals < 1 || reals > MOST_REALS) return 2;
    for (int i = 0; i < reals; i++) reference[i] = (fmi2ValueReference)strtoul(given[4 + i], NULL, 10);

    fmi2Component instance = ((fmi2InstantiateTYPE *)needed(library, "fmi2Instantiate"))(
        "probe", fmi2CoSimulation, guid, resources, &callbacks, fmi2False, fmi2False);
    if (instance == NULL) return 1;
    if (((fmi2SetupExperimentTYPE *)needed(library, "fmi2SetupExperiment"))(instance, fmi2False, 0.0, 0.0, fmi2True,
                                                                             stop_s) != fmi2OK ||
        ((fmi2EnterInitializationModeTYPE *)needed(library, "fmi2EnterInitializationMode"))(instance) != fmi2OK ||
        ((fmi2ExitInitializationModeTYPE *)needed(library, "fmi2ExitInitializationMode"))(instance) != fmi2OK)
        return 1;
    fmi2DoStepTYPE *do_step = (fmi2DoStepTYPE *)needed(library, "fmi2DoStep");
    for (long k = 0; k < steps; k++)
        if (do_step(instance, (double)k * step_s, step_s, fmi2True) != fmi2OK) return 1;
    if (((fmi2GetRealTYPE *)needed(library, "fmi2GetReal"))(instance, reference, (size_t)reals, value) != fmi2OK)
        return 1;
    for (int i = 0; i < reals; i++) {
        unsigned long long bits;
        memcpy(&bits, &value[i], sizeof bits);
        printf("%016llx\n", bits);
    }
    ((fmi2FreeInstanceTYPE *)needed(library, "fmi2FreeInstance"))(instance);
    return 0;
}

int main(int count, char **given) {
    void *library = count > 2 ? open_library(given[2]) : NULL;
    if (library == NULL) {
        fprintf(stderr, "probe: cannot load %s\n", count > 2 ? given[2] : "nothing");
        return 2;
    }
    if (strcmp(given[1], "core") == 0) return check_core(library);
    return run_fmu(library, given + 3, count - 3);
}
