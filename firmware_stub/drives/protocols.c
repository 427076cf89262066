/* The list of all protocols. It links every protocol; firmware with one uses that one's name instead. */
#include "laconic_drives/protocol.h"

static const laconic_drive_protocol *const protocols[] = {
    [1] = &laconic_canopen, [2] = &laconic_odrive,          [3] = &laconic_robomaster,
    [4] = &laconic_moteus,  [5] = &laconic_robomaster_c610,
};

const laconic_drive_protocol *laconic_drive_protocol_by_number(int32_t number) {
    const int32_t count = (int32_t)(sizeof protocols / sizeof protocols[0]);
    return number >= 0 && number < count ? protocols[number] : NULL;
}
