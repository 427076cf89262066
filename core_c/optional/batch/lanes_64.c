/* Lanes of 64 bytes, for processors with AVX-512: eight doubles or sixteen floats side by side. */
#include "lanes_builds.h"

#ifdef LANES_OF_64
#define LANES_BYTES 64
#define LANES_WITH_AVX
#define LANES_WITH_CONVERSIONS
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl")
#endif
#include "lanes_step.h"
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
