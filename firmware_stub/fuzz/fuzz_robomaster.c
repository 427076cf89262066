/* Any frames for two RoboMaster C620. */
#include "fuzz_drives.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) { return fuzz(&laconic_robomaster, 1, data, size); }
