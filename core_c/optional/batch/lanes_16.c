/* Lanes of 16 bytes, which every processor of x86-64 and AArch64 has: two doubles or four floats side by side. */
#include "lanes_builds.h"

#ifdef LANES_OF_16
#define LANES_BYTES 16
#ifdef __ARM_NEON
#define LANES_WITH_CONVERSIONS
#endif
#include "lanes_step.h"
#endif
