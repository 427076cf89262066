/* The list of all methods. It links every method; firmware with one fixed method uses that one's name instead. */
#include "common.h"

#define FIRST (1 - LACONIC_WITH_EXPONENTIAL_GAUSS) /* without that method there is no auto, which has the number 0 */

static const laconic_method *const methods[LACONIC_METHOD_COUNT] = {
#if LACONIC_WITH_EXPONENTIAL_GAUSS
    &laconic_auto,
#else
    NULL, /* auto steps by exponential-gauss-8 */
#endif
    &laconic_rk4,
    &laconic_exponential_kahan,
    &laconic_exponential_kahan_4,
    &laconic_exact_flow,
    &laconic_exact_flow_4,
    &laconic_taylor_8,
#if LACONIC_WITH_EXPONENTIAL_GAUSS
    &laconic_exponential_gauss_8,
#endif
};

static bool same_text(const char *a, const char *b) {
    for (; *a != '\0' && *a == *b; a++) b++;
    return *a == *b;
}

const laconic_method *laconic_method_by_number(int32_t number) {
    return number >= 0 && number < LACONIC_METHOD_COUNT ? methods[number] : NULL;
}

const laconic_method *laconic_method_by_name(const char *name) {
    for (int32_t i = FIRST; i < LACONIC_METHOD_COUNT; i++)
        if (same_text(methods[i]->name, name)) return methods[i];
    return NULL;
}
