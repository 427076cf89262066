/* Calls of every public function of the node, for Frama-C's analyser: proof/__init__.py runs each entry. The node is
 * any node: every member has any value that its functions leave there. */
#include "laconic_node/node.h"
#include "laconic_node/crc.h"
#include "laconic_node/e2e.h"
#include "laconic_node/protection.h"
#include "laconic_node/slcan.h"

#include "__fc_builtin.h"

#define ANYTHING(thing) Frama_C_make_unknown((char *)&(thing), sizeof(thing))
#define ANY_BOOL() ((bool)Frama_C_interval(0, 1))
#define ANY_WORD() Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU)

static laconic_frame frame;

/* As a port makes it: at most so many bytes as a frame holds. */
static void any_frame(void) {
    ANYTHING(frame);
    frame.extended = ANY_BOOL();
    frame.remote = ANY_BOOL();
    frame.fd = ANY_BOOL();
    frame.bit_rate_switch = ANY_BOOL();
    frame.length = Frama_C_unsigned_char_interval(0, LACONIC_FRAME_BYTES);
}

#define ANY_BYTE() Frama_C_unsigned_char_interval(0, 255)
/* A receiver that laconic_e2e_check() alone has changed has fewer. */
#define ANY_STRAYS() Frama_C_unsigned_char_interval(0, LACONIC_E2E_RESYNC - 1)

void prove_checksums(void) {
    static uint8_t data[LACONIC_FRAME_BYTES];
    const uint8_t offset = (uint8_t)Frama_C_interval_split(0, LACONIC_WIRE_OFFSETS - 1);
    laconic_e2e_receiver receiver = {ANY_BOOL(), ANY_BYTE(), ANY_BYTE(), ANY_STRAYS(), ANY_BYTE()};
    ANYTHING(data);
    (void)laconic_mix(ANY_WORD(), ANY_WORD());
    (void)laconic_run_key(ANY_WORD(), ANY_WORD());
    (void)laconic_plain_is_right(offset, data);
    (void)laconic_keyed_is_right(offset, data, ANY_WORD(), ANY_WORD());
    (void)laconic_counter_of(offset, data);
    laconic_protect_plain(offset, data, ANY_BYTE());
    laconic_protect_keyed(offset, data, ANY_WORD(), ANY_WORD());
    (void)laconic_crc32(ANY_WORD(), data, sizeof data);
    (void)laconic_e2e_accepts(
        laconic_e2e_check(&receiver, ANY_BOOL(), ANY_BYTE(),
                          ANY_BOOL() ? LACONIC_E2E_P22_COUNTER_MASK : LACONIC_E2E_P05_COUNTER_MASK, ANY_BYTE()));
}

void prove_slcan(void) {
    static laconic_slcan slcan;
    char text[LACONIC_SLCAN_LINE];
    laconic_slcan_init(&slcan, '5');
    while (ANY_BOOL()) (void)laconic_slcan_feed(&slcan, (char)ANY_BYTE(), &frame);
    any_frame();
    (void)laconic_slcan_write(&slcan, &frame, text);
}

void prove_loader(void) {
    static laconic_loader loader;
    static uint8_t data[8];
    uint8_t field, item;
    laconic_loader_begin(&loader);
    while (ANY_BOOL()) {
        ANYTHING(data);
        laconic_loader_take(&loader, data);
    }
    (void)laconic_loader_check(&loader, (uint16_t)ANY_WORD(), ANY_WORD(), &field, &item);
}

void prove_raw_input(void) {
    static laconic_raw_input raw;
    static laconic_input input[3];
    static uint8_t bytes[LACONIC_FRAME_BYTES];
    const int32_t wheels = Frama_C_interval(0, LACONIC_MAX_WHEELS);
    raw.take = ANY_BYTE();
#if LACONIC_NODE_WITH_HINGES
    static laconic_articulated_input hinged[2];
    static laconic_real angle_rad[LACONIC_MAX_BODIES];
    raw.take_hinges = (uint8_t)(ANY_BYTE() & LACONIC_RAW_HINGE_TAKES);
    raw.hinge_count = Frama_C_interval(0, LACONIC_MAX_BODIES);
    raw.hinged = hinged;
    raw.angle_rad = angle_rad;
#endif
    laconic_raw_restart(&raw);
    while (ANY_BOOL()) {
        ANYTHING(bytes);
        (void)laconic_raw_take(&raw, input, wheels, ANY_BYTE(), ANY_BYTE(), bytes,
                               Frama_C_unsigned_char_interval(0, LACONIC_FRAME_BYTES));
        (void)laconic_raw_is_whole(&raw, (uint16_t)ANY_WORD());
    }
}
