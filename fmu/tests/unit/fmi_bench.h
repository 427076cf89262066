/* What the tests of both FMI versions share beside shared_bench.h: an instance by FMI 2. */
#ifndef FMI_BENCH_H
#define FMI_BENCH_H

#include "fmi2Functions.h"
#include "shared_bench.h"

#include <stdlib.h>

static void log_2(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String category, fmi2String text,
                  ...) {
    (void)e;
    (void)name;
    (void)status;
    log_line(category, text);
}

static inline fmi2Component make_2(fmi2Type kind, const char *token) {
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL};
    return fmi2Instantiate("one", kind, token, NULL, &callbacks, fmi2False, fmi2True);
}

#endif
