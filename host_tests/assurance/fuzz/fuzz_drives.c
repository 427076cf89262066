/* Any frames at any time, for the drives of a protocol on flywheels: what they send are frames, and what they ask of
 * their motors are numbers.
 *
 * Input: records. The first byte n: up to 127 it is followed by a frame, identifier (4 bytes; bit 31 remote, bit 30 FD,
 * bit 29 29-bit) and n modulo 65 bytes; from 128 on one to eight steps are taken (three bits), before each of which no
 * time or 1 ms to 16 s pass (four bits: a power of two), so that a silence costs as much as a step. A frame that is
 * both remote and FD, which no bus has, stands for faults by order: bit 0 of the identifier is the drive, the bits
 * above are the orders. The protocol is an option, FUZZ_ROBOMASTER (C610 by the first byte's lowest bit, else C620),
 * FUZZ_MOTEUS or FUZZ_ODRIVE. */
#include "laconic_drives/protocol.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FUZZ_DRIVES = 2, FUZZ_GUARD = 0x5A };

static laconic_drives drives;
static struct {
    uint64_t axes[FUZZ_DRIVES * 128];
    uint8_t guard[16];
} memory;
static laconic_real speed[FUZZ_DRIVES];
static uint32_t now_us;

static void must(bool holds) {
    if (!holds) abort();
}

static void begin(const laconic_drive_protocol *protocol, int32_t first_id) {
    const laconic_drive_settings settings = {
        .encoder_counts = 16384,
        .gear_ratio = -3,
        .torque_constant_Nm_per_A = (laconic_real)0.05,
        .current_limit_A = 20,
        .speed_limit_rad_per_s = 100,
        .supply_V = 24,
        .winding_resistance_ohm = (laconic_real)0.1,
        .current_bandwidth_rad_per_s = 1000,
        .position_gain_per_s = 20,
        .speed_gain_As = 2,
        .speed_integral_gain_A = 10,
    };
    memset(&drives, 0, sizeof drives);
    memset(&memory, 0, sizeof memory);
    memset(memory.guard, FUZZ_GUARD, sizeof memory.guard);
    memset(speed, 0, sizeof speed);
    now_us = 0xFFFFF000U;
    drives.protocol = protocol;
    drives.axes = memory.axes;
    drives.count = FUZZ_DRIVES;
    drives.step_s = (laconic_real)0.001;
    drives.watchdog_s = (laconic_real)0.5;
    for (int32_t i = 0; i < FUZZ_DRIVES; i++) {
        laconic_drive_start(&drives.drive[i], &settings);
        drives.drive[i].settings.node_id = first_id + i;
    }
    must(protocol->axis_bytes <= sizeof memory.axes / FUZZ_DRIVES);
    protocol->start(&drives, now_us);
}

static void take_frames(void) {
    laconic_frame frame;
    int32_t count = 0;
    for (; drives.protocol->next_frame(&drives, &frame); count++) {
        must(frame.length <= (frame.fd ? 64 : 8) && frame.id <= (frame.extended ? 0x1FFFFFFFU : 0x7FFU));
        must(count < 1000);
    }
}

static void step(uint32_t passes_us) {
    now_us += passes_us;
    drives.protocol->on_step(&drives, now_us);
    for (int32_t i = 0; i < FUZZ_DRIVES; i++) {
        const laconic_real torque_Nm = laconic_drive_act(&drives.drive[i], drives.step_s);
        must(torque_Nm - torque_Nm == 0 && !(drives.drive[i].faults & LACONIC_DRIVE_FAULT_TARGET));
        speed[i] += torque_Nm / (laconic_real)0.01 * drives.step_s;
        laconic_drive_measure(&drives.drive[i], speed[i] * drives.step_s, speed[i]);
    }
}

static int fuzz(const laconic_drive_protocol *protocol, int32_t first_id, const uint8_t *data, size_t size) {
    begin(protocol, first_id);
    while (size > 0) {
        const uint8_t what = *data++;
        size--;
        if (what > 127) {
            const uint32_t power = what >> 3 & 15U;
            for (int32_t k = what & 7; k >= 0; k--) step(power > 0 ? 1000U << (power - 1U) : 0);
            take_frames();
            continue;
        }
        const uint8_t length = (uint8_t)(what % (LACONIC_FRAME_BYTES + 1));
        if (size < 4U + length) break;
        uint32_t id;
        memcpy(&id, data, 4);
        if (id >> 30 == 3U) {
            laconic_drive_order(&drives.drive[id & 1U], id >> 1 & LACONIC_DRIVE_ORDERS);
            data += 4;
            size -= 4;
            continue;
        }
        laconic_frame frame = {.id = id & 0x1FFFFFFFU};
        frame.remote = id >> 31;
        frame.fd = id >> 30 & 1U;
        frame.extended = id >> 29 & 1U;
        if (!frame.extended) frame.id &= 0x7FFU;
        frame.length = frame.fd || length <= 8 ? length : 8;
        memcpy(frame.data, data + 4, length);
        protocol->on_frame(&drives, &frame, now_us);
        data += 4 + length;
        size -= 4U + length;
        if (what & 64U) take_frames();
    }
    take_frames();
    for (size_t k = 0; k < sizeof memory.guard; k++) must(memory.guard[k] == FUZZ_GUARD);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
#ifdef FUZZ_ROBOMASTER
    const laconic_drive_protocol *const protocol =
        size > 0 && (data[0] & 1U) ? &laconic_robomaster_c610 : &laconic_robomaster;
    return size > 0 ? fuzz(protocol, 1, data + 1, size - 1) : 0;
#elif defined FUZZ_MOTEUS
    return fuzz(&laconic_moteus, 1, data, size);
#else
    return fuzz(&laconic_odrive, 0, data, size);
#endif
}
