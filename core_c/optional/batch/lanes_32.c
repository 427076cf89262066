/* Lanes of 32 bytes, for processors with AVX2: four doubles or eight floats side by side. */
#include "lanes_builds.h"

#ifdef LANES_OF_32
#define LANES_BYTES 32
#define LANES_WITH_AVX
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#include "lanes_step.h"
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
