/* Which integrators an image holds: all, or the one that LACONIC_NODE_ONE_METHOD names by number and symbol. */
#include "methods.h"

const laconic_method *port_method(int32_t number) {
#ifdef LACONIC_NODE_ONE_METHOD
    return number == LACONIC_NODE_ONE_METHOD_NUMBER ? &LACONIC_NODE_ONE_METHOD : NULL;
#else
    return laconic_method_by_number(number);
#endif
}
