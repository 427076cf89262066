/* Frames of the rig wait for their code. */
#include "laconic_secure/gate.h"

#include "laconic_wire.h"

#include <string.h>

#define CODE_BYTES 8U

void LACONIC_GATE_BUILT(void) {}

void(laconic_gate_init)(laconic_gate *gate, uint32_t id_base, const uint8_t key[LACONIC_AES_BYTES]) {
    memset(gate, 0, sizeof *gate);
    gate->id_base = id_base;
    laconic_cmac_key_of(&gate->key, key);
}

/* What a frame is to the gate: of the rig, a code, or none of its business. */
static bool is_ours(const laconic_gate *gate, const laconic_frame *frame, uint32_t *offset) {
    *offset = frame->id - gate->id_base;
    return !frame->extended && *offset <= LACONIC_GATE_OFFSET;
}

static bool needs_code(const laconic_frame *frame, uint32_t offset) {
    return LACONIC_WIRE_FROM_RIG(offset) && offset != LACONIC_WIRE_HELLO && !frame->remote;
}

static uint16_t number_of(const laconic_gate *gate, uint32_t offset) { return (uint16_t)(gate->id_base + offset); }

/* The code of the frame that waits; any other ends its wait. */
static bool take_code(laconic_gate *gate, const laconic_frame *frame, laconic_frame *out) {
    const laconic_frame *payload = &gate->held;
    const bool is_code = gate->waits && frame->length == CODE_BYTES && gate->id_base + frame->data[0] == payload->id;
    gate->waits = false;
    if (!is_code) {
        gate->bare++;
        return false;
    }
    uint64_t freshness = gate->freshness;
    laconic_secoc_status status =
        laconic_secoc_open(&gate->key, number_of(gate, frame->data[0]), &freshness, payload->data, payload->length,
                           frame->data + 1, LACONIC_SECOC_APART);
    if (freshness >> 32 != gate->freshness >> 32) status = LACONIC_SECOC_SPENT;
    if (status == LACONIC_SECOC_OK) gate->freshness = freshness;
    gate->refused[status]++;
    *out = *payload;
    return status == LACONIC_SECOC_OK;
}

bool laconic_gate_take(laconic_gate *gate, const laconic_frame *frame, laconic_frame *out) {
    uint32_t offset;
    const bool ours = is_ours(gate, frame, &offset);
    if (ours && offset == LACONIC_GATE_OFFSET) return take_code(gate, frame, out);
    if (ours && needs_code(frame, offset)) {
        if (gate->waits) gate->bare++;
        gate->held = *frame;
        gate->waits = laconic_frame_fits(frame);
        return false;
    }
    *out = *frame;
    return true;
}

void laconic_gate_sent(laconic_gate *gate, const laconic_frame *frame) {
    uint32_t offset, nonce = 0;
    if (!is_ours(gate, frame, &offset) || offset != LACONIC_WIRE_CHALLENGE || frame->length != CODE_BYTES) return;
    for (unsigned k = 0; k < 4; k++) nonce |= (uint32_t)frame->data[2 + k] << (8U * k);
    if (gate->freshness >> 32 != nonce) gate->freshness = (uint64_t)nonce << 32;
}

bool laconic_gate_is_spent(const laconic_gate *gate, const laconic_frame *frame) {
    uint32_t offset;
    return is_ours(gate, frame, &offset) && needs_code(frame, offset) && (uint32_t)gate->freshness == UINT32_MAX;
}

bool laconic_gate_seal(laconic_gate *gate, const laconic_frame *frame, laconic_frame *code) {
    uint32_t offset;
    if (!is_ours(gate, frame, &offset) || !needs_code(frame, offset) || !laconic_frame_fits(frame)) return false;
    if (laconic_gate_is_spent(gate, frame)) return false;
    memset(code, 0, sizeof *code);
    code->id = gate->id_base + LACONIC_GATE_OFFSET;
    code->length = CODE_BYTES;
    code->data[0] = (uint8_t)offset;
    gate->freshness++;
    return laconic_secoc_seal(&gate->key, number_of(gate, offset), gate->freshness, frame->data, frame->length,
                              code->data + 1, LACONIC_SECOC_APART);
}
