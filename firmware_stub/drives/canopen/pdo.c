/* Process data: which objects a frame carries, and when it is sent or takes effect. The mapping is changed as CiA 301
 * says: switch the PDO off (bit 31 of its COB-ID), set the number of objects to 0, map, set the number, switch it on.
 *
 * A frame that is sent holds the newest values at that moment; nothing is queued. */
#include "canopen.h"

#include <string.h>

enum { SYNCHRONOUS_LAST = 240, EVENT_FIRST = 254 };

/* Number of the PDO of an object: bit 11 of its index tells those that are sent. */
static uint32_t number_of(uint16_t index) { return (index & 3U) | (index >> 9 & CANOPEN_PDOS); }

static bool is_on(const canopen_pdo *pdo) { return (pdo->cob_id & CANOPEN_OFF) == 0; }

static uint8_t length_of(const canopen_pdo *pdo) {
    uint8_t bytes = 0;
    for (uint8_t k = 0; k < pdo->count; k++) bytes = (uint8_t)(bytes + canopen_size(canopen_row_at(pdo->row[k])));
    return bytes;
}

/* --- after a reset ----------------------------------------------------------------------------------------------- */

typedef struct preset {
    uint16_t cob_id, timer_ms;
    uint8_t type;
    uint16_t index[2]; /* 0: none */
} preset;

static const preset presets[2 * CANOPEN_PDOS] = {
    {0x200, 0, 255, {0x6040, 0x6060}},
    {0x300, 0, 255, {0x60FF, 0}},
    {0x400, 0, 255, {0x607A, 0}},
    {0x500, 0, 255, {0x6071, 0}},
    {0x180 | CANOPEN_NO_REMOTE, 100, 255, {0x6041, 0}},
    {0x280 | CANOPEN_NO_REMOTE, 0, 1, {0x6064, 0x606C}},
    {0x380 | CANOPEN_NO_REMOTE | CANOPEN_OFF, 0, 1, {0x6077, 0x6078}},
    {0x480 | CANOPEN_NO_REMOTE | CANOPEN_OFF, 0, 1, {0x60F4, 0x6061}},
};

/* A scene's watchdog watches the targets, which a controller sends all the time; the controlword it may send once. */
void canopen_start_pdos(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    const laconic_real wanted_ms = on->watchdog_s * 1000 + (laconic_real)0.5;
    const uint16_t watchdog_ms = wanted_ms < UINT16_MAX ? (uint16_t)wanted_ms : UINT16_MAX;
    memset(axis->pdo, 0, sizeof axis->pdo);
    for (int k = 0; k < 2 * CANOPEN_PDOS; k++) {
        const preset *from = &presets[k];
        canopen_pdo *pdo = &axis->pdo[k];
        uint32_t abort;
        memset(pdo->row, CANOPEN_NO_ROW, sizeof pdo->row);
        pdo->cob_id = (uint16_t)(from->cob_id + canopen_id(on));
        pdo->type = from->type;
        pdo->timer_ms = k > 0 && k < CANOPEN_PDOS ? watchdog_ms : from->timer_ms;
        for (; pdo->count < 2 && from->index[pdo->count] != 0; pdo->count++)
            pdo->row[pdo->count] = canopen_find(from->index[pdo->count], 0, &abort);
    }
    axis->received = 0;
}

/* --- configuration ----------------------------------------------------------------------------------------------- */

static uint32_t mapping_of(const canopen_pdo *pdo, uint8_t k) {
    const canopen_row *row = canopen_row_at(pdo->row[k]);
    return row == NULL ? 0 : (uint32_t)row->index << 16 | (uint32_t)canopen_sub(row) << 8 | 8U * canopen_size(row);
}

uint32_t canopen_pdo_read(const canopen_axis *axis, uint16_t index, uint8_t sub, uint32_t *value) {
    const canopen_pdo *pdo = &axis->pdo[number_of(index)];
    if (index & 0x0200U) {
        *value = sub == 0 ? pdo->count : mapping_of(pdo, (uint8_t)(sub - 1));
        return 0;
    }
    switch (sub) {
    case 1: *value = canopen_cob_id(pdo->cob_id); break;
    case 2: *value = pdo->type; break;
    case 3: *value = pdo->inhibit_100us; break;
    default: *value = pdo->timer_ms; break;
    }
    return 0;
}

static uint32_t map_object(canopen_pdo *pdo, uint8_t k, uint32_t value, uint8_t direction) {
    uint32_t abort = 0;
    uint8_t number = CANOPEN_NO_ROW;
    if (pdo->count != 0) return CANOPEN_PRESENT_STATE;
    if (value != 0) {
        number = canopen_find((uint16_t)(value >> 16), (uint8_t)(value >> 8), &abort);
        const canopen_row *row = canopen_row_at(number);
        if (row == NULL) return abort;
        if ((row->form & direction) == 0 || (value & 255U) != 8U * canopen_size(row)) return CANOPEN_NOT_MAPPABLE;
    }
    pdo->row[k] = number;
    return 0;
}

static uint32_t set_count(canopen_pdo *pdo, uint32_t count) {
    uint32_t abort = 0;
    if (count > CANOPEN_MAPPED) return CANOPEN_PDO_TOO_LONG;
    for (uint32_t k = 0; k < count; k++) {
        if (pdo->row[k] == CANOPEN_NO_ROW) return CANOPEN_NOT_MAPPABLE;
    }
    const uint8_t before = pdo->count;
    pdo->count = (uint8_t)count;
    if (length_of(pdo) > 8) {
        pdo->count = before;
        abort = CANOPEN_PDO_TOO_LONG;
    }
    return abort;
}

/* A PDO that is switched on begins anew: nothing waits for SYNC, and no deadline runs. */
static uint32_t set_cob_id(const canopen_node *on, canopen_pdo *pdo, uint16_t index, uint32_t value) {
    const uint32_t abort = canopen_store_cob_id(&pdo->cob_id, value);
    if (abort != 0) return abort;
    pdo->at_us = on->now_us;
    memset(pdo->data, 0, sizeof pdo->data);
    if (index & 0x0800U)
        on->axis->syncs[index & 3U] = 0;
    else
        on->axis->received &= (uint8_t)~(17U << (index & 3U));
    return 0;
}

uint32_t canopen_pdo_write(const canopen_node *on, uint16_t index, uint8_t sub, uint32_t value) {
    canopen_pdo *pdo = &on->axis->pdo[number_of(index)];
    if ((index & 0x0200U) != 0) {
        if (is_on(pdo)) return CANOPEN_PRESENT_STATE;
        if (sub == 0) return set_count(pdo, value);
        return map_object(pdo, (uint8_t)(sub - 1), value, (index & 0x0800U) != 0 ? CANOPEN_TX : CANOPEN_RX);
    }
    switch (sub) {
    case 1: return set_cob_id(on, pdo, index, value);
    case 2:
        if (value > SYNCHRONOUS_LAST && value < EVENT_FIRST) return CANOPEN_VALUE;
        pdo->type = (uint8_t)value;
        return 0;
    case 3:
        if (is_on(pdo)) return CANOPEN_PRESENT_STATE;
        pdo->inhibit_100us = (uint16_t)value;
        return 0;
    default: pdo->timer_ms = (uint16_t)value; return 0;
    }
}

/* --- receiving --------------------------------------------------------------------------------------------------- */

/* A value that its object refuses is passed over: the object keeps what it had. */
static void apply(const canopen_node *on, const canopen_pdo *pdo) {
    const uint8_t *at = pdo->data;
    for (uint8_t k = 0; k < pdo->count; k++) {
        const canopen_row *row = canopen_row_at(pdo->row[k]);
        const uint8_t size = canopen_size(row);
        if (canopen_is_from_axis(row)) canopen_write(on, row, row->index, canopen_sub(row), canopen_get(at, size));
        at += size;
    }
}

static void take(const canopen_node *on, int k, const laconic_frame *frame) {
    canopen_axis *axis = on->axis;
    canopen_pdo *pdo = &axis->pdo[k];
    const uint8_t length = length_of(pdo), troubles = (uint8_t)(CANOPEN_TROUBLE_LENGTH | CANOPEN_TROUBLE_DEADLINE << k);
    if (frame->length < length) {
        if ((axis->trouble & CANOPEN_TROUBLE_LENGTH) == 0) canopen_emergency(axis, 0x8210);
        axis->trouble |= CANOPEN_TROUBLE_LENGTH;
        return;
    }
    axis->trouble &= (uint8_t)~troubles;
    canopen_all_clear(axis);
    memcpy(pdo->data, frame->data, length);
    pdo->at_us = on->now_us;
    axis->received |= (uint8_t)(16U << k);
    if (pdo->type <= SYNCHRONOUS_LAST)
        axis->received |= (uint8_t)(1U << k);
    else
        apply(on, pdo);
}

bool canopen_take_pdo(const canopen_node *on, const laconic_frame *frame) {
    canopen_axis *axis = on->axis;
    bool is_taken = false;
    for (int k = 0; k < CANOPEN_PDOS; k++) {
        const uint16_t received_id = axis->pdo[k].cob_id & (CANOPEN_OFF | 0x7FF); /* bit 30 means nothing here */
        if (!frame->remote && received_id == frame->id) {
            take(on, k, frame);
            is_taken = true;
        }
        const uint16_t sent_id = axis->pdo[CANOPEN_PDOS + k].cob_id; /* equal only where remote requests are allowed */
        if (frame->remote && sent_id == frame->id) axis->due |= (uint8_t)(CANOPEN_DUE_TPDO << k);
    }
    return is_taken;
}

void canopen_check_deadlines(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    for (int k = 0; k < CANOPEN_PDOS; k++) {
        const canopen_pdo *pdo = &axis->pdo[k];
        const uint8_t watched = (uint8_t)(16U << k);
        if ((axis->received & watched) == 0 || pdo->timer_ms == 0) continue;
        if (on->now_us - pdo->at_us <= 1000U * pdo->timer_ms) continue;
        axis->received &= (uint8_t)~watched;
        axis->trouble |= watched; /* CANOPEN_TROUBLE_DEADLINE << k */
        canopen_connection_lost(on, 0x8250);
    }
}

/* --- sending ----------------------------------------------------------------------------------------------------- */

static void pack(const canopen_node *on, const canopen_pdo *pdo, uint8_t data[8]) {
    memset(data, 0, 8);
    for (uint8_t k = 0; k < pdo->count; k++) {
        const canopen_row *row = canopen_row_at(pdo->row[k]);
        const uint8_t size = canopen_size(row);
        uint32_t value = 0;
        canopen_read(on, row, row->index, canopen_sub(row), &value);
        canopen_put(data, value, size);
        data += size;
    }
}

static void set_due(const canopen_node *on, int k) {
    on->axis->pdo[CANOPEN_PDOS + k].at_us = on->now_us;
    on->axis->due |= (uint8_t)(CANOPEN_DUE_TPDO << k);
}

static bool has_changed(const canopen_node *on, const canopen_pdo *pdo) {
    uint8_t now[8], differences = 0;
    pack(on, pdo, now);
    for (int k = 0; k < 8; k++) differences |= now[k] ^ pdo->data[k];
    return differences != 0;
}

void canopen_sync(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    for (int k = 0; k < CANOPEN_PDOS; k++) {
        if ((axis->received & 1U << k) != 0) apply(on, &axis->pdo[k]);
    }
    axis->received &= 0xF0U;
    for (int k = 0; k < CANOPEN_PDOS; k++) {
        const canopen_pdo *pdo = &axis->pdo[CANOPEN_PDOS + k];
        if (!is_on(pdo) || pdo->type > SYNCHRONOUS_LAST) continue;
        const bool is_due = pdo->type == 0 ? has_changed(on, pdo) : ++axis->syncs[k] >= pdo->type;
        if (is_due) set_due(on, k);
        if (is_due) axis->syncs[k] = 0;
    }
}

void canopen_find_due_pdos(const canopen_node *on) {
    for (int k = 0; k < CANOPEN_PDOS; k++) {
        const canopen_pdo *pdo = &on->axis->pdo[CANOPEN_PDOS + k];
        const uint32_t passed_us = on->now_us - pdo->at_us;
        if (!is_on(pdo) || pdo->type < EVENT_FIRST || passed_us < 100U * pdo->inhibit_100us) continue;
        if ((pdo->timer_ms != 0 && passed_us >= 1000U * pdo->timer_ms) || has_changed(on, pdo)) set_due(on, k);
    }
}

/* The first frames tell a controller where the drive is. */
void canopen_pdos_begin(const canopen_node *on) {
    on->axis->received = 0;
    for (int k = 0; k < CANOPEN_PDOS; k++) {
        const canopen_pdo *pdo = &on->axis->pdo[CANOPEN_PDOS + k];
        on->axis->syncs[k] = 0;
        if (is_on(pdo) && pdo->type >= EVENT_FIRST) set_due(on, k);
    }
}

void canopen_send_pdo(const canopen_node *on, int k, laconic_frame *frame) {
    canopen_pdo *pdo = &on->axis->pdo[CANOPEN_PDOS + k];
    pack(on, pdo, pdo->data);
    frame->id = pdo->cob_id & 0x7FFU;
    frame->length = length_of(pdo);
    memcpy(frame->data, pdo->data, 8);
}
