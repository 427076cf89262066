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

static unsigned category_bit(const char *name) {
    if (name == NULL) return 0;
    if (strcmp(name, "logAll") == 0) return FMU_LOG_ALL;
    for (size_t k = 0; k < CATEGORY_COUNT; k++)
        if (strcmp(categories[k].name, name) == 0) return (unsigned)categories[k].category;
    return 0;
}

/* No categories mean all. FMI 2: `on` selects these and no others, off none. FMI 3: `on` adds these, off removes
 * them. A category of another FMU is ignored with a warning: an importer may have one list for all of its FMUs. */
fmu_status fmu_set_logging(fmu_instance *instance, bool on, size_t count, const char *const names[]) {
    unsigned wanted = count == 0 ? FMU_LOG_ALL : 0;
    fmu_status status = FMU_OK;
    if (count > 0 && names == NULL)
        return fmu_refuse(instance, "SetDebugLogging: %zu categories and no list of them", count);
    for (size_t k = 0; k < count; k++) {
        const unsigned bit = category_bit(names[k]);
        if (bit == 0)
            status = fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING,
                             "SetDebugLogging: there is no category '%s', which is ignored; use logStatusWarning, "
                             "logStatusDiscard, logStatusError or logEvents",
                             names[k] != NULL ? names[k] : "(null)");
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
