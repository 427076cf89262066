/* A version whose parts have two digits each, in place of the core's own. It is read before all else (-include), by the
 * test of the version and by node_pack.c as that test links it. */
#ifndef OTHER_VERSION_H
#define OTHER_VERSION_H

#include "laconic/laconic.h"

#undef LACONIC_VERSION
#define LACONIC_VERSION "12.34.56"

#endif
