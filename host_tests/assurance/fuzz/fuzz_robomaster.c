/* Any frames for two RoboMaster C620, or C610 by the first byte's lowest bit. */
#include "fuzz_drives.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const laconic_drive_protocol *const protocol =
        size > 0 && (data[0] & 1U) ? &laconic_robomaster_c610 : &laconic_robomaster;
    return size > 0 ? fuzz(protocol, 1, data + 1, size - 1) : 0;
}
