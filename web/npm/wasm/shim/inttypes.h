/* As much of it as core_c/tests/bits/trajectory_hash.c uses. */
#ifndef LACONIC_SHIM_INTTYPES_H
#define LACONIC_SHIM_INTTYPES_H
#include <stdint.h>
#define PRIx64 "llx"
#endif
