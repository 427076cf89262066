/* Any frames for two moteus controllers. */
#include "fuzz_drives.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) { return fuzz(&laconic_moteus, 1, data, size); }
