/* The memory that an XCP master sees: outputs, numbers of the vehicle on two pages, texts. Addresses are virtual. */
#include "node_internal.h"

#if LACONIC_NODE_WITH_XCP

#include <string.h>

enum { NUMBER_BYTES = 4, MOST_DOWNLOADED = 6 };

/* Bits of SET_CAL_PAGE: whose page. */
enum { OF_NODE = 1, OF_MASTER = 2, OF_ALL_SEGMENTS = 0x80 };

/* First bits of signals in SELECT that name outputs. */
enum {
    BIT_STEPS = 0,
    BIT_RAW = 24,
    BIT_RAW_ENCODER = 30,
    BIT_VOLTAGE = 32,
    BIT_HELD_TORQUE = 36,
    BIT_ESTIMATE = 37,
    BIT_RAW_HINGES = 43,
    BIT_RAW_HINGE_RATE = 45
};

#define TEXT_OF(number) #number
#define IDENTIFICATION_OF(version) "laconic_" TEXT_OF(version)

/* The identification, which is the name of the A2L file, and the names of the events. */
const char laconic_xcp_texts[1U + LACONIC_XCP_EVENTS][LACONIC_XCP_TEXT_BYTES] = {
    IDENTIFICATION_OF(LACONIC_WIRE_VERSION), "step", "10 ms", "100 ms"};

/* ------------------------------------------------------------------------------------ outputs -- */

static void put_real(uint8_t *to, laconic_real value) {
    const float single = (float)value;
    memcpy(to, &single, sizeof single);
}

/* Chooses the one output; false iff this vehicle or this build has none such. */
static bool choose(const laconic_node *node, laconic_raw_output *raw, uint32_t bit) {
    raw->send = 0;
    if (bit >= BIT_RAW && bit <= BIT_RAW_ENCODER) raw->send = (uint8_t)(1U << (bit - BIT_RAW));
    if (bit == BIT_HELD_TORQUE) raw->send = LACONIC_RAW_HELD_TORQUE;
    raw->send &= (uint8_t)~RAW_LEFT_OUT;
#if LACONIC_NODE_WITH_HINGES
    const bool of_hinges = bit >= BIT_RAW_HINGES && bit <= BIT_RAW_HINGE_RATE;
    raw->send_hinges = of_hinges && has_hinges(node) ? (uint8_t)(1U << (bit - BIT_RAW_HINGES)) : 0U;
    if (has_hinges(node)) raw->send &= (uint8_t)~RAW_NOT_OF_HINGES;
    if (raw->send_hinges != 0) return true;
#else
    (void)node;
#endif
    return raw->send != 0;
}

static void collect(laconic_node *node, laconic_raw_output *raw) {
    const laconic_sensor_outputs *outputs = NULL;
#if LACONIC_NODE_WITH_SENSORS
    laconic_sensor_outputs sensed;
    if ((raw->send & RAW_OF_SENSORS) != 0) {
        node->xcp.senses = true;
        laconic_sensors_read(&sensed, &node->sensors, &node->plant, &node->input[0]);
        outputs = &sensed;
    }
#endif
#if LACONIC_NODE_WITH_HINGES
    if (has_hinges(node)) {
        laconic_node_collect_hinges(raw, node);
        return;
    }
#endif
    laconic_raw_collect(raw, &node->plant, &node->input[0], outputs);
}

/* Of one moment each output is collected once, as long as its numbers are read one after the other. */
static uint8_t output_of_steps(laconic_node *node, uint32_t bit, uint32_t k, uint8_t *to) {
    laconic_raw_output *raw = &node->xcp.seen;
    if (node->xcp.seen_bit != bit) {
        node->xcp.seen_bit = 0;
        if (!choose(node, raw, bit)) return XCP_ACCESS_DENIED;
        collect(node, raw);
        node->xcp.seen_bit = (uint8_t)bit;
    }
    if (k >= raw->size / sizeof(laconic_real)) return XCP_ACCESS_DENIED;
    put_real(to, raw->number[k]);
    return XCP_DONE;
}

static uint8_t count_or_state(const laconic_node *node, uint32_t k, uint8_t *to) {
    if (k > 1) return XCP_ACCESS_DENIED;
    put32(to, k == 0 ? (uint32_t)node->plant.steps : (uint32_t)node->state);
    return XCP_DONE;
}

static uint8_t voltage(const laconic_node *node, uint32_t k, uint8_t *to) {
    if (k >= (uint32_t)node->plant.model.wheel_count) return XCP_ACCESS_DENIED;
    put_real(to, node->input[0].voltage_V[k]);
    return XCP_DONE;
}

/* Number k as page k of ERROR_ESTIMATE. */
static uint8_t estimate(const laconic_node *node, uint32_t k, uint8_t *to) {
#if LACONIC_NODE_WITH_ESTIMATE
    const laconic_error *sizes = k < 4 ? &node->estimated.now : &node->estimated.largest;
    const laconic_real size[4] = {sizes->nu_rad_per_s, sizes->place_m, sizes->heading_rad, sizes->wheel_angle_rad};
    if (k >= LACONIC_NODE_ESTIMATE_PAGES || !estimates(node)) return XCP_ACCESS_DENIED;
    put_real(to, size[k & 3U]);
    return XCP_DONE;
#else
    (void)node;
    (void)k;
    (void)to;
    return XCP_ACCESS_DENIED;
#endif
}

static uint8_t output(laconic_node *node, uint32_t place, uint8_t *to) {
    const uint32_t bit = place / LACONIC_XCP_EACH, k = place % LACONIC_XCP_EACH / NUMBER_BYTES;
    if (bit == BIT_STEPS) return count_or_state(node, k, to);
    if (!has_model(node)) return XCP_NOT_NOW;
    if (bit == BIT_VOLTAGE) return voltage(node, k, to);
    return bit == BIT_ESTIMATE ? estimate(node, k, to) : output_of_steps(node, bit, k, to);
}

/* --------------------------------------------------------------------------- numbers of a page -- */

static bool find(laconic_loader_place *place, uint32_t at) {
    return laconic_loader_find(place, (uint8_t)(at / LACONIC_XCP_EACH),
                               (uint8_t)(at % LACONIC_XCP_EACH / NUMBER_BYTES));
}

static uint32_t integer_at(const uint8_t *from, uint8_t kind) {
    int32_t number = 0;
    bool flag = false;
    if (kind == LACONIC_KIND_WHEEL_KIND) return (uint32_t)*(const laconic_wheel_kind *)from;
    if (kind == LACONIC_KIND_INTEGER) {
        memcpy(&number, from, sizeof number);
        return (uint32_t)number;
    }
    memcpy(&flag, from, sizeof flag);
    return flag != (kind == LACONIC_KIND_ABSENCE);
}

/* Where the vehicle has no number, 0: so a segment can be read and summed as a whole. */
static void load(const laconic_vehicle *page, uint32_t at, uint8_t *to) {
    laconic_loader_place place;
    laconic_real value;
    memset(to, 0, NUMBER_BYTES);
    if (!find(&place, at)) return;
    const uint8_t *from = (const uint8_t *)page + place.offset;
    if (place.kind == LACONIC_KIND_REAL) {
        memcpy(&value, from, sizeof value);
        put_real(to, value);
    } else {
        put32(to, integer_at(from, place.kind));
    }
}

/* An integer or a flag; kinds of wheels stay. False iff no number of that kind has this value. */
static bool store_integer(uint8_t *to, uint8_t kind, uint32_t value) {
    const int32_t number = (int32_t)value;
    const bool flag = (value != 0) != (kind == LACONIC_KIND_ABSENCE);
    if (kind == LACONIC_KIND_INTEGER) {
        memcpy(to, &number, sizeof number);
        return true;
    }
    if (value <= 1U) memcpy(to, &flag, sizeof flag);
    return value <= 1U;
}

/* A number that is there already keeps the digits that single precision does not show. */
static bool store(laconic_vehicle *page, uint32_t at, const uint8_t *bytes) {
    laconic_loader_place place;
    uint8_t present[NUMBER_BYTES];
    float single;
    load(page, at, present);
    if (memcmp(present, bytes, sizeof present) == 0 || !find(&place, at)) return true;
    uint8_t *to = (uint8_t *)page + place.offset;
    if (place.kind != LACONIC_KIND_REAL) return store_integer(to, place.kind, word32(bytes));
    memcpy(&single, bytes, sizeof single);
    const laconic_real value = (laconic_real)single;
    memcpy(to, &value, sizeof value);
    return true;
}

/* ------------------------------------------------------------------------------------- reading -- */

static uint8_t number_at(laconic_node *node, uint32_t address, uint8_t *to) {
    const uint32_t place = address & 0xFFFFU;
    switch (address - place) {
    case LACONIC_XCP_OUTPUTS: return output(node, place, to);
    case LACONIC_XCP_TEXTS:
        if (place >= sizeof laconic_xcp_texts) return XCP_ACCESS_DENIED;
        memcpy(to, &laconic_xcp_texts[place / LACONIC_XCP_TEXT_BYTES][place % LACONIC_XCP_TEXT_BYTES], NUMBER_BYTES);
        return XCP_DONE;
    case LACONIC_XCP_PARAMETERS:
        if (place >= LACONIC_XCP_SEGMENT) return XCP_ACCESS_DENIED;
        if (!has_model(node)) return XCP_NOT_NOW;
        load(&node->xcp.page[node->xcp.master_page], place, to);
        return XCP_DONE;
    default: return XCP_ACCESS_DENIED;
    }
}

uint8_t laconic_xcp_read(laconic_node *node, uint32_t address, uint8_t *to, uint32_t count) {
    uint8_t number[NUMBER_BYTES];
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t byte = (address + k) % NUMBER_BYTES;
        if (k == 0 || byte == 0) {
            const uint8_t error = number_at(node, address + k - byte, number);
            if (error != XCP_DONE) return error;
        }
        to[k] = number[byte];
    }
    return XCP_DONE;
}

/* ------------------------------------------------------------------------------------- writing -- */

void laconic_xcp_adopt(laconic_node *node, const laconic_vehicle *vehicle) {
    laconic_xcp *xcp = &node->xcp;
    xcp->page[LACONIC_XCP_WORKING_PAGE] = *vehicle;
    xcp->page[LACONIC_XCP_REFERENCE_PAGE] = *vehicle;
    xcp->node_page = LACONIC_XCP_WORKING_PAGE;
    xcp->master_page = LACONIC_XCP_WORKING_PAGE;
    xcp->part_address = 0;
}

static void tell_rig(laconic_node *node, const laconic_refusal *why) {
    const laconic_node_result result = {0, LACONIC_WIRE_COMMAND_CALIBRATE, (uint8_t)why->status, (uint8_t)why->field,
                                        (uint8_t)why->item};
    laconic_node_answer(node, LACONIC_WIRE_HELLO, result); /* to which no other RESULT belongs */
}

/* Rig and master learn status, field and item. */
static uint8_t refuse(laconic_node *node, uint8_t error, const laconic_refusal *why) {
    laconic_xcp_packet *answer = &node->xcp.answer;
    tell_rig(node, why);
    answer->data[2] = (uint8_t)why->status;
    answer->data[3] = (uint8_t)why->field;
    answer->data[4] = (uint8_t)why->item;
    answer->length = 5;
    return error;
}

/* The node runs on this page from the next step on, or nothing changes. */
static uint8_t run_on(laconic_node *node, uint8_t page, uint8_t error) {
    laconic_refusal why = {0};
    if (!has_hinges(node)) {
        if (laconic_plant_change(&node->plant, &node->xcp.page[page], &why) != LACONIC_OK)
            return refuse(node, error, &why);
#if LACONIC_NODE_WITH_ESTIMATE
        if (estimates(node) && laconic_node_start_estimate(node, &why) != LACONIC_OK) tell_rig(node, &why);
#endif
    }
    node->xcp.node_page = page;
    return XCP_DONE;
}

/* Whether the vehicle has the wheel or support that a number is of. */
static bool is_of_vehicle(const laconic_vehicle *page, const laconic_loader_place *place, uint32_t at) {
    const int32_t k = (int32_t)(at % LACONIC_XCP_EACH / NUMBER_BYTES);
    if (place->stride == sizeof(laconic_wheel)) return k < page->wheel_count;
    return place->stride == 0 || k < page->support_count;
}

/* What laconic_plant_change() does not change: how many wheels and supports there are, kinds of wheels and places. */
static bool stays(uint32_t field) {
    return (field >= LACONIC_FIELD_WHEEL_COUNT && field <= LACONIC_FIELD_ROLLER) ||
           field == LACONIC_FIELD_SUPPORT_COUNT;
}

static uint8_t may_write(const laconic_node *node, uint32_t address) {
    const uint32_t at = address & 0xFFFFU;
    const laconic_xcp *xcp = &node->xcp;
    laconic_loader_place place;
    if (address - at == LACONIC_XCP_OUTPUTS || address - at == LACONIC_XCP_TEXTS) return XCP_WRITE_PROTECTED;
    if (address - at != LACONIC_XCP_PARAMETERS || at >= LACONIC_XCP_SEGMENT) return XCP_ACCESS_DENIED;
    if (!has_model(node)) return XCP_NOT_NOW;
    if (has_hinges(node) || xcp->master_page == LACONIC_XCP_REFERENCE_PAGE) return XCP_WRITE_PROTECTED;
    if (!find(&place, at) || !is_of_vehicle(&xcp->page[0], &place, at)) return XCP_ACCESS_DENIED;
    return stays(at / LACONIC_XCP_EACH) ? XCP_WRITE_PROTECTED : XCP_DONE;
}

/* One byte; a number is stored with its last one. False iff no such number has that value. */
static bool write_byte(laconic_xcp *xcp, uint32_t address, uint8_t byte) {
    const uint32_t number = address - address % NUMBER_BYTES;
    laconic_vehicle *page = &xcp->page[LACONIC_XCP_WORKING_PAGE];
    if (number != xcp->part_address) load(page, number & 0xFFFFU, xcp->part);
    xcp->part_address = number;
    xcp->part[address % NUMBER_BYTES] = byte;
    if (address % NUMBER_BYTES + 1U < NUMBER_BYTES) return true;
    xcp->part_address = 0;
    return store(page, number & 0xFFFFU, xcp->part);
}

static uint8_t refuse_integer(laconic_node *node, uint32_t at) {
    laconic_loader_place place = {0, 0, 0};
    const uint32_t k = at % LACONIC_XCP_EACH / NUMBER_BYTES;
    const laconic_refusal why = {.status = (laconic_status)LACONIC_WIRE_STATUS_OUT_OF_RANGE,
                                 .field = (laconic_field)(at / LACONIC_XCP_EACH),
                                 .item = find(&place, at) && place.stride > 0 ? (int32_t)k + 1 : 0};
    return refuse(node, XCP_OUT_OF_RANGE, &why);
}

static uint8_t write_all(laconic_node *node, const uint8_t *from, uint8_t count) {
    laconic_xcp *xcp = &node->xcp;
    const uint32_t first = xcp->address;
    for (uint8_t k = 0; k < count; k++)
        if (!write_byte(xcp, first + k, from[k])) return refuse_integer(node, (first + k) & 0xFFFFU);
    const bool is_whole = first % NUMBER_BYTES + count >= NUMBER_BYTES;
    if (!is_whole || xcp->node_page != LACONIC_XCP_WORKING_PAGE) return XCP_DONE;
    return run_on(node, LACONIC_XCP_WORKING_PAGE, XCP_OUT_OF_RANGE);
}

/* Writes all bytes or none. */
uint8_t laconic_xcp_write(laconic_node *node, const uint8_t *from, uint8_t count) {
    laconic_xcp *xcp = &node->xcp;
    const laconic_vehicle before = xcp->page[LACONIC_XCP_WORKING_PAGE];
    if (count == 0 || count > MOST_DOWNLOADED) return XCP_OUT_OF_RANGE;
    for (uint8_t k = 0; k < count; k++) {
        const uint8_t error = may_write(node, xcp->address + k);
        if (error != XCP_DONE) return error;
    }
    const uint8_t error = write_all(node, from, count);
    if (error != XCP_DONE) {
        xcp->page[LACONIC_XCP_WORKING_PAGE] = before;
        xcp->part_address = 0;
    }
    xcp->address += error == XCP_DONE ? count : 0U;
    return error;
}

/* -------------------------------------------------------------------------------------- pages -- */

uint8_t laconic_xcp_set_page(laconic_node *node, const uint8_t *command) {
    const uint8_t mode = command[1], segment = command[2], page = command[3];
    laconic_xcp *xcp = &node->xcp;
    if ((mode & (OF_NODE | OF_MASTER)) == 0 || (mode & ~(OF_NODE | OF_MASTER | OF_ALL_SEGMENTS)) != 0)
        return XCP_MODE_NOT_VALID;
    if (segment != 0 && (mode & OF_ALL_SEGMENTS) == 0) return XCP_SEGMENT_NOT_VALID;
    if (page > LACONIC_XCP_REFERENCE_PAGE) return XCP_PAGE_NOT_VALID;
    if (!has_model(node)) return XCP_NOT_NOW;
    if ((mode & OF_NODE) != 0 && page != xcp->node_page) {
        const uint8_t error = run_on(node, page, XCP_PAGE_NOT_VALID);
        if (error != XCP_DONE) return error;
    }
    if ((mode & OF_MASTER) != 0) xcp->master_page = page;
    return XCP_DONE;
}

uint8_t laconic_xcp_get_page(laconic_xcp *xcp, const uint8_t *command) {
    if (command[1] != OF_NODE && command[1] != OF_MASTER) return XCP_MODE_NOT_VALID;
    if (command[2] != 0) return XCP_SEGMENT_NOT_VALID;
    xcp->answer.data[3] = command[1] == OF_NODE ? xcp->node_page : xcp->master_page;
    xcp->answer.length = 4;
    return XCP_DONE;
}

uint8_t laconic_xcp_copy_page(laconic_node *node, const uint8_t *command) {
    laconic_xcp *xcp = &node->xcp;
    const uint8_t from = command[2], to = command[4];
    if (command[1] != 0 || command[3] != 0) return XCP_SEGMENT_NOT_VALID;
    if (from > LACONIC_XCP_REFERENCE_PAGE || to > LACONIC_XCP_REFERENCE_PAGE) return XCP_PAGE_NOT_VALID;
    if (to == LACONIC_XCP_REFERENCE_PAGE) return XCP_WRITE_PROTECTED;
    if (!has_model(node)) return XCP_NOT_NOW;
    const laconic_vehicle before = xcp->page[to];
    xcp->part_address = 0;
    xcp->page[to] = xcp->page[from];
    if (xcp->node_page != to) return XCP_DONE;
    const uint8_t error = run_on(node, to, XCP_PAGE_NOT_VALID);
    if (error != XCP_DONE) xcp->page[to] = before;
    return error;
}

#endif
