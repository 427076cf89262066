/* The SDO server of a node: expedited and segmented up- and downloads, one at a time. A wrong request is answered with
 * an abort code and changes nothing. */
#include "../octets.h"
#include "canopen.h"

enum { DOWNLOAD_SEGMENT = 0, DOWNLOAD = 1, UPLOAD = 2, UPLOAD_SEGMENT = 3, ABORT = 4 }; /* bits 7–5 of a request */
enum { EXPEDITED = 2, HAS_SIZE = 1, TOGGLE = 16, LAST = 1 };
enum { STEP_NONE = 0, STEP_UP = 1, STEP_DOWN = 2 }; /* sdo_step, with TOGGLE as it is expected next */

/* Each takes a request and fills the answer but for the object's name; it gives an abort code, 0 iff done. */

static uint32_t upload(const canopen_node *on, const canopen_row *row) {
    canopen_axis *axis = on->axis;
    uint32_t value = 0;
    if ((row->form & CANOPEN_R) == 0) return CANOPEN_NO_ACCESS; /* no object can only be written */
    const uint8_t size = canopen_size(row);
    if (size > 0) {
        const uint32_t abort = canopen_read(on, row, axis->sdo_index, axis->sdo_sub, &value);
        axis->sdo_answer[0] = (uint8_t)(UPLOAD << 5 | (4 - size) << 2 | EXPEDITED | HAS_SIZE);
        canopen_put(axis->sdo_answer + 4, value, size);
        return abort;
    }
    for (const char *text = canopen_text(axis->sdo_index); *text != 0; text++) value++;
    axis->sdo_answer[0] = UPLOAD << 5 | HAS_SIZE;
    octets_put_u32(axis->sdo_answer + 4, value);
    axis->sdo_step = STEP_UP;
    return 0;
}

static uint32_t check_size(uint32_t length, uint8_t size) {
    return length > size ? CANOPEN_TOO_LONG : length < size ? CANOPEN_TOO_SHORT : 0;
}

static uint32_t write(const canopen_node *on, const canopen_row *row, const uint8_t *bytes) {
    const uint32_t value = canopen_get(bytes, canopen_size(row));
    return canopen_write(on, row, on->axis->sdo_index, on->axis->sdo_sub, value);
}

static uint32_t download(const canopen_node *on, const canopen_row *row, const uint8_t *request) {
    const uint8_t command = request[0], size = canopen_size(row);
    uint32_t abort = 0;
    if ((row->form & CANOPEN_W) == 0) return row->form & CANOPEN_R ? CANOPEN_READ_ONLY : CANOPEN_NO_ACCESS;
    on->axis->sdo_answer[0] = 3 << 5;
    if (command & EXPEDITED) {
        if (command & HAS_SIZE) abort = check_size(4U - (command >> 2 & 3U), size);
        return abort != 0 ? abort : write(on, row, request + 4);
    }
    if (command & HAS_SIZE) abort = check_size(octets_u32(request + 4), size);
    if (abort == 0) on->axis->sdo_step = STEP_DOWN;
    return abort;
}

static uint32_t initiate(const canopen_node *on, const uint8_t *request) {
    canopen_axis *axis = on->axis;
    uint32_t abort;
    axis->sdo_index = (uint16_t)octets_u16(request + 1);
    axis->sdo_sub = request[3];
    axis->sdo_at = axis->sdo_step = STEP_NONE;
    axis->sdo_row = canopen_find(axis->sdo_index, axis->sdo_sub, &abort);
    const canopen_row *row = canopen_row_at(axis->sdo_row);
    if (row == NULL) return abort;
    return request[0] >> 5 == UPLOAD ? upload(on, row) : download(on, row, request);
}

static uint32_t upload_segment(canopen_axis *axis) {
    const char *text = canopen_text(axis->sdo_index) + axis->sdo_at;
    uint8_t count = 0;
    for (; count < 7 && text[count] != 0; count++) axis->sdo_answer[1 + count] = (uint8_t)text[count];
    const bool last = text[count] == 0;
    axis->sdo_at = (uint8_t)(axis->sdo_at + count);
    axis->sdo_answer[0] = (uint8_t)((axis->sdo_step & TOGGLE) | (7 - count) << 1 | (last ? LAST : 0));
    axis->sdo_step = last ? STEP_NONE : axis->sdo_step ^ TOGGLE;
    return 0;
}

static uint32_t download_segment(const canopen_node *on, const uint8_t *request) {
    canopen_axis *axis = on->axis;
    const canopen_row *row = canopen_row_at(axis->sdo_row);
    const uint8_t count = 7 - (request[0] >> 1 & 7U), size = canopen_size(row);
    if (axis->sdo_at + count > size) return CANOPEN_TOO_LONG;
    for (uint8_t k = 0; k < count; k++) axis->sdo_data[axis->sdo_at++] = request[1 + k];
    axis->sdo_answer[0] = (uint8_t)(1U << 5 | (axis->sdo_step & TOGGLE));
    axis->sdo_step ^= TOGGLE;
    if ((request[0] & LAST) == 0) return 0;
    axis->sdo_step = STEP_NONE;
    return axis->sdo_at < size ? CANOPEN_TOO_SHORT : write(on, row, axis->sdo_data);
}

static uint32_t segment(const canopen_node *on, const uint8_t *request) {
    const uint8_t step = on->axis->sdo_step;
    const bool up = request[0] >> 5 == UPLOAD_SEGMENT;
    if ((step & ~TOGGLE) != (up ? STEP_UP : STEP_DOWN)) return CANOPEN_COMMAND;
    if ((step ^ request[0]) & TOGGLE) return CANOPEN_TOGGLE;
    return up ? upload_segment(on->axis) : download_segment(on, request);
}

void canopen_sdo(const canopen_node *on, const uint8_t request[8]) {
    canopen_axis *axis = on->axis;
    const uint8_t kind = request[0] >> 5;
    const bool starts = kind == DOWNLOAD || kind == UPLOAD;
    uint32_t abort = CANOPEN_COMMAND;
    if (kind == ABORT) {
        axis->sdo_step = STEP_NONE;
        return;
    }
    memset(axis->sdo_answer, 0, sizeof axis->sdo_answer);
    if (starts) abort = initiate(on, request);
    if (kind == DOWNLOAD_SEGMENT || kind == UPLOAD_SEGMENT) abort = segment(on, request);
    if (abort != 0) {
        axis->sdo_step = STEP_NONE;
        axis->sdo_answer[0] = ABORT << 5;
        octets_put_u32(axis->sdo_answer + 4, abort);
    }
    if (starts || abort != 0) {
        octets_put_u16(axis->sdo_answer + 1, axis->sdo_index);
        axis->sdo_answer[3] = axis->sdo_sub;
    }
    axis->due |= CANOPEN_DUE_SDO;
}
