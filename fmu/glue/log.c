/* Lines for the importer's log. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "instance.h"

static const struct {
    fmu_category category;
    const char *name;
} categories[] = {
    {FMU_LOG_WARNING, "logStatusWarning"},
    {FMU_LOG_DISCARD, "logStatusDiscard"},
    {FMU_LOG_ERROR, "logStatusError"},
    {FMU_LOG_EVENTS, "logEvents"},
};
#define CATEGORY_COUNT (sizeof categories / sizeof categories[0])

/* Makes " nan" of " -nan": NaN has no sign, though some C libraries print one. */
static void unsign_nan(char *line) {
    char *found;
    while ((found = strstr(line, " -nan")) != NULL) memmove(found + 1, found + 2, strlen(found + 1));
}

static void deliver(const fmu_instance *instance, fmu_status status, fmu_category category, const char *format,
                    va_list arguments) {
    char line[FMU_LINE_LENGTH];
    /* errors are always logged, as FMI 3.0 requires */
    if (instance->deliver == NULL || !((instance->log_categories | FMU_LOG_ERROR) & (unsigned)category)) return;
    (void)vsnprintf(line, sizeof line, format, arguments);
    unsign_nan(line);
    for (size_t k = 0; k < CATEGORY_COUNT; k++)
        if (categories[k].category == category) instance->deliver(instance, status, categories[k].name, line);
}

fmu_status fmu_log(const fmu_instance *instance, fmu_status status, fmu_category category, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    deliver(instance, status, category, format, arguments);
    va_end(arguments);
    return status;
}

fmu_status fmu_refuse(const fmu_instance *instance, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    deliver(instance, FMU_ERROR, FMU_LOG_ERROR, format, arguments);
    va_end(arguments);
    return FMU_ERROR;
}

static bool look_alike(double a, double b, int digits) {
    char one[32], other[32];
    (void)snprintf(one, sizeof one, "%.*g", digits, a);
    (void)snprintf(other, sizeof other, "%.*g", digits, b);
    return a != b && strcmp(one, other) == 0;
}

int fmu_digits(double a, double b, double c) {
    int digits = 15; /* those of every decimal number that a double holds; 17 tell all doubles apart */
    while (digits < 17 && (look_alike(a, b, digits) || look_alike(b, c, digits) || look_alike(a, c, digits))) digits++;
    return digits;
}

fmu_status fmu_refuse_start(const fmu_instance *instance, double at_s, double now_s) {
    const int digits = fmu_digits(at_s, now_s, now_s);
    return fmu_refuse(instance, "the step starts at %.*g s, but the model is at %.*g s", digits, at_s, digits, now_s);
}

fmu_status fmu_refuse_end(const fmu_instance *instance, double from_s, double to_s) {
    const double stop_s = instance->clock.stop_s;
    const int digits = fmu_digits(from_s, to_s, stop_s);
    return fmu_refuse(instance, "the step from %.*g s to %.*g s goes beyond the stop time %.*g s", digits, from_s,
                      digits, to_s, digits, stop_s);
}

static unsigned category_bit(const char *name) {
    if (name == NULL) return 0;
    if (strcmp(name, "logAll") == 0) return FMU_LOG_ALL;
    for (size_t k = 0; k < CATEGORY_COUNT; k++)
        if (strcmp(categories[k].name, name) == 0) return (unsigned)categories[k].category;
    return 0;
}

/* Some importers ask for categories of other tools: a warning, in whatever categories, lets them continue. */
static void warn_of_category(const fmu_instance *instance, const char *name) {
    char line[FMU_LINE_LENGTH];
    if (instance->deliver == NULL) return;
    (void)snprintf(line, sizeof line,
                   "SetDebugLogging: there is no category '%.200s', which is left out; use logStatusWarning, "
                   "logStatusDiscard, logStatusError, logEvents or, for all of them, logAll",
                   name != NULL ? name : "(null)");
    instance->deliver(instance, FMU_WARNING, "logStatusWarning", line);
}

/* No categories mean all. FMI 2: `on` selects these and no others, off none. FMI 3: `on` adds these, off removes
 * them. */
fmu_status fmu_set_logging(fmu_instance *instance, bool on, size_t count, const char *const names[]) {
    unsigned wanted = count == 0 ? FMU_LOG_ALL : 0;
    fmu_status status = FMU_OK;
    if (count > 0 && names == NULL)
        return fmu_refuse(instance, "SetDebugLogging: %zu categories and no list of them", count);
    for (size_t k = 0; k < count; k++) {
        const unsigned bit = category_bit(names[k]);
        if (bit == 0) {
            warn_of_category(instance, names[k]);
            status = FMU_WARNING;
        }
        wanted |= bit;
    }
    if (instance->version == 2)
        instance->log_categories = on ? wanted : 0;
    else if (on)
        instance->log_categories |= wanted;
    else
        instance->log_categories &= ~wanted;
    return status;
}
