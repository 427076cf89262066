/* Calls of the functions by which frames carry a code, for Frama-C's analyser: any key, message and frame. */
#include "laconic_secure/gate.h"

#include "__fc_builtin.h"

#define ANYTHING(thing) Frama_C_make_unknown((char *)&(thing), sizeof(thing))
#define ANY_BOOL() ((bool)Frama_C_interval(0, 1))
#define ANY_LENGTH(most) ((size_t)Frama_C_unsigned_int_interval(0, most))

static uint8_t bytes[LACONIC_AES_BYTES], message[256], trailer[1 + LACONIC_AES_BYTES];

void prove_cmac(void) {
    static laconic_cmac_key key;
    uint8_t mac[LACONIC_AES_BYTES];
    ANYTHING(bytes);
    ANYTHING(message);
    laconic_cmac_key_of(&key, bytes);
    laconic_cmac(&key, message, ANY_LENGTH(sizeof message), mac);
    (void)laconic_same_bytes(mac, bytes, ANY_LENGTH(LACONIC_AES_BYTES));
}

/* A payload of at most LACONIC_SECOC_LONGEST bytes, as secoc.h asks for. */
void prove_secoc(void) {
    static laconic_cmac_key key;
    uint64_t last;
    const size_t length = ANY_LENGTH(LACONIC_SECOC_LONGEST), code = ANY_LENGTH(LACONIC_AES_BYTES);
    ANYTHING(key);
    ANYTHING(last);
    ANYTHING(message);
    ANYTHING(trailer);
    (void)laconic_secoc_text((laconic_secoc_status)Frama_C_interval(-2147483647 - 1, 2147483647));
    (void)laconic_secoc_open(&key, (uint16_t)ANY_LENGTH(0xFFFF), &last, message, length, trailer, code);
    laconic_secoc_seal(&key, (uint16_t)ANY_LENGTH(0xFFFF), last, message, length, trailer, code);
}

static void any_frame(laconic_frame *of) {
    Frama_C_make_unknown((char *)of, sizeof *of);
    of->extended = ANY_BOOL();
    of->remote = ANY_BOOL();
    of->fd = ANY_BOOL();
    of->bit_rate_switch = ANY_BOOL();
    of->length = Frama_C_unsigned_char_interval(0, LACONIC_FRAME_BYTES);
}

/* A gate from power-up on, any frames in any order. */
void prove_gate(void) {
    static laconic_gate gate;
    static laconic_frame frame, other;
    ANYTHING(bytes);
    laconic_gate_init(&gate, Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU), bytes);
    while (ANY_BOOL()) {
        any_frame(&frame);
        (void)laconic_gate_take(&gate, &frame, &other);
        laconic_gate_sent(&gate, &frame);
        (void)laconic_gate_seal(&gate, &frame, &other);
    }
}
