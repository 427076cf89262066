/* The methods in an image: all, or the one that LACONIC_NODE_ONE_METHOD and LACONIC_NODE_ONE_METHOD_NUMBER name. */
#include "methods.h"

const laconic_method *port_method(int32_t number) {
#ifdef LACONIC_NODE_ONE_METHOD
    return number == LACONIC_NODE_ONE_METHOD_NUMBER ? &LACONIC_NODE_ONE_METHOD : NULL;
#else
    return laconic_method_by_number(number);
#endif
}
