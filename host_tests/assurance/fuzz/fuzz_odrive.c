/* Any frames for two ODrives. */
#include "fuzz_drives.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) { return fuzz(&laconic_odrive, 0, data, size); }
