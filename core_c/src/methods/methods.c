/* The table of all methods, from their list in laconic/methods.h. It links every method; firmware with one fixed method
 * uses that one's name instead. */
#include "common.h"

/* The row of a method that this build leaves out is NULL, so that the others keep their numbers. */
#define ROW_WITH_NOTHING(method) method
#if LACONIC_WITH_EXPONENTIAL_GAUSS
#define ROW_WITH_EXPONENTIAL_GAUSS(method) method
#else
#define ROW_WITH_EXPONENTIAL_GAUSS(method) NULL
#endif
#define ROW(number, identifier, name, order, TAKES, KEEPS, NEEDS, title) ROW_WITH_##NEEDS(&laconic_##identifier),

static const laconic_method *const methods[] = {LACONIC_METHODS(ROW)};

static bool same_text(const char *a, const char *b) {
    for (; *a != '\0' && *a == *b; a++) b++;
    return *a == *b;
}

const laconic_method *laconic_method_by_number(int32_t number) {
    return number >= 0 && number < LACONIC_METHOD_COUNT ? methods[number] : NULL;
}

const laconic_method *laconic_method_by_name(const char *name) {
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++)
        if (methods[i] != NULL && same_text(methods[i]->name, name)) return methods[i];
    return NULL;
}
