/* Errors of a node: register, history, EMCY frames, and what the loss of the controller does. */
#include "../octets.h"
#include "canopen.h"

/* Bit of the error register by the class of the code: voltage, temperature, communication, the device. No error here is
 * of the current alone. */
static uint8_t register_bit(uint16_t code) {
    switch (code >> 12) {
    case 3: return 4;
    case 4: return 8;
    default: return code >> 8 == 0x81 || code >> 8 == 0x82 ? 16 : 32;
    }
}

/* A node whose EMCY is switched off keeps its errors for those who ask. */
static void announce(canopen_axis *axis) {
    if ((axis->emergency_id & CANOPEN_OFF) == 0)
        axis->due |= CANOPEN_DUE_EMERGENCY;
    else
        axis->emergencies = 0;
}

void canopen_emergency(canopen_axis *axis, uint16_t code) {
    for (int k = CANOPEN_HISTORY - 1; k > 0; k--) axis->history[k] = axis->history[k - 1];
    axis->history[0] = code;
    if (axis->history_count < CANOPEN_HISTORY) axis->history_count++;
    if (axis->emergencies < axis->history_count) axis->emergencies++;
    axis->error_register |= (uint8_t)(1U | register_bit(code));
    announce(axis);
}

/* Error reset: EMCY 0000, iff no error remains. */
void canopen_all_clear(canopen_axis *axis) {
    const bool remains = (axis->trouble & CANOPEN_TROUBLE) != 0;
    if (remains || axis->state >= CANOPEN_FAULT_REACTION || axis->error_register == 0) return;
    axis->error_register = 0;
    announce(axis);
}

/* 0x1029 says what becomes of the communication, 0x6007 what of the drive. */
void canopen_connection_lost(const canopen_node *on, uint16_t code) {
    canopen_axis *axis = on->axis;
    on->drive->unheard = true;
    if (axis->connection_option != 1) canopen_emergency(axis, code); /* a fault tells it itself */
    canopen_connection_option(on, code);
    if (axis->behaviour == 0 && axis->nmt == CANOPEN_OPERATIONAL) canopen_set_nmt(on, CANOPEN_PRE_OPERATIONAL);
    if (axis->behaviour == 2) canopen_set_nmt(on, CANOPEN_STOPPED);
}

/* Oldest first, so that a reset comes last. */
void canopen_send_emergency(const canopen_node *on, laconic_frame *frame) {
    canopen_axis *axis = on->axis;
    const uint16_t code = axis->emergencies > 0 ? axis->history[axis->emergencies - 1] : 0;
    frame->id = axis->emergency_id & 0x7FFU;
    frame->length = 8;
    octets_put_u16(frame->data, code);
    frame->data[2] = axis->error_register;
    octets_put_u32(frame->data + 3, on->drive->faults);
    frame->data[7] = 0;
    if (axis->emergencies > 0) axis->emergencies--;
    if (axis->emergencies > 0 || (code != 0 && axis->error_register == 0)) axis->due |= CANOPEN_DUE_EMERGENCY;
}
