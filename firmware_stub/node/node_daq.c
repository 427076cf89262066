/* Measurement by XCP: dynamic lists of outputs, sampled after steps, with stamps of the node's integer time. */
#include "node_internal.h"

#if LACONIC_NODE_WITH_XCP

#include <string.h>

/* The order in which lists are allocated. */
enum { PHASE_NONE, PHASE_FREE, PHASE_LISTS, PHASE_ODTS, PHASE_ENTRIES };

/* Bits of SET_DAQ_LIST_MODE; the others are not supported. */
enum { MODE_STAMPED = 0x10 };

enum { ODT_BYTES = 7, STAMP_BYTES = 4, NO_BIT = 0xFF, ENTRY_ADDRESS_BITS = 24 };

/* Nanoseconds of each event; 0: the step. */
static const uint32_t period_ns[LACONIC_XCP_EVENTS] = {0U, 10000000U, 100000000U};

/* ---------------------------------------------------------------------------------------- time -- */

/* A step's nanoseconds are a whole number, so that stamps are exact for every step of whole microseconds. */
static uint64_t step_ns(const laconic_node *node) {
    const laconic_real ns_per_s = (laconic_real)1e9;
    return (uint64_t)(node->plant.integrator.step_s * ns_per_s + (laconic_real)0.5);
}

static uint64_t time_ns(const laconic_node *node) { return node->plant.steps * step_ns(node); }

static uint32_t stamp_us(const laconic_node *node) { return (uint32_t)(time_ns(node) / 1000U); }

/* Whether the last step has reached or passed a multiple of the event's period. */
static bool is_due(const laconic_node *node, uint8_t event) {
    const uint64_t now = time_ns(node);
    const uint32_t period = period_ns[event];
    return period == 0 || now / period != (now - step_ns(node)) / period;
}

/* --------------------------------------------------------------------------------------- lists -- */

static bool is_list(const laconic_xcp *xcp, const uint8_t *number) { return word16(number) < xcp->list_count; }

static bool is_odt(const laconic_xcp *xcp, const uint8_t *command) {
    return is_list(xcp, command + 2) && command[4] < xcp->list[command[2]].odts;
}

bool laconic_daq_runs(const laconic_xcp *xcp) {
    for (uint8_t k = 0; k < xcp->list_count; k++)
        if (xcp->list[k].running) return true;
    return false;
}

void laconic_daq_clear(laconic_xcp *xcp) {
    memset(xcp->list, 0, sizeof xcp->list);
    xcp->list_count = 0;
    xcp->odt_count = 0;
    xcp->entry_count = 0;
    xcp->waiting = 0;
    xcp->phase = PHASE_NONE;
}

static uint8_t free_lists(laconic_xcp *xcp) {
    laconic_daq_clear(xcp);
    xcp->at_list = 0;
    xcp->phase = PHASE_FREE;
    return XCP_DONE;
}

static uint8_t alloc_lists(laconic_xcp *xcp, uint16_t count) {
    if (xcp->phase != PHASE_FREE) return XCP_SEQUENCE;
    if (count > LACONIC_XCP_LISTS) return XCP_MEMORY_OVERFLOW;
    xcp->list_count = (uint8_t)count;
    xcp->phase = PHASE_LISTS;
    return XCP_DONE;
}

static uint8_t alloc_odts(laconic_xcp *xcp, const uint8_t *command) {
    if (xcp->phase != PHASE_LISTS && xcp->phase != PHASE_ODTS) return XCP_SEQUENCE;
    if (!is_list(xcp, command + 2)) return XCP_OUT_OF_RANGE;
    laconic_xcp_list *list = &xcp->list[command[2]];
    if (list->odts > 0) return XCP_SEQUENCE;
    if (command[4] > LACONIC_XCP_ODTS - xcp->odt_count) return XCP_MEMORY_OVERFLOW;
    list->first_odt = xcp->odt_count;
    list->odts = command[4];
    memset(&xcp->odt[list->first_odt], 0, list->odts * sizeof xcp->odt[0]);
    xcp->odt_count = (uint8_t)(xcp->odt_count + list->odts);
    xcp->phase = PHASE_ODTS;
    return XCP_DONE;
}

static uint8_t alloc_entries(laconic_xcp *xcp, const uint8_t *command) {
    if (xcp->phase != PHASE_ODTS && xcp->phase != PHASE_ENTRIES) return XCP_SEQUENCE;
    if (!is_odt(xcp, command)) return XCP_OUT_OF_RANGE;
    laconic_xcp_odt *odt = &xcp->odt[xcp->list[command[2]].first_odt + command[4]];
    if (odt->entries > 0) return XCP_SEQUENCE;
    if (command[5] > LACONIC_XCP_ENTRIES - xcp->entry_count) return XCP_MEMORY_OVERFLOW;
    odt->first_entry = xcp->entry_count;
    odt->entries = command[5];
    memset(&xcp->entry[odt->first_entry], 0, odt->entries * sizeof xcp->entry[0]);
    xcp->entry_count = (uint8_t)(xcp->entry_count + odt->entries);
    xcp->phase = PHASE_ENTRIES;
    return XCP_DONE;
}

static uint8_t set_pointer(laconic_xcp *xcp, const uint8_t *command) {
    if (!is_odt(xcp, command)) return XCP_OUT_OF_RANGE;
    if (command[5] >= xcp->odt[xcp->list[command[2]].first_odt + command[4]].entries) return XCP_OUT_OF_RANGE;
    xcp->at_list = command[2];
    xcp->at_odt = command[4];
    xcp->at_entry = command[5];
    return XCP_DONE;
}

/* Where WRITE_DAQ writes; NULL: SET_DAQ_PTR is missing, or the last entry has been written. */
static uint32_t *entry_at(laconic_xcp *xcp) {
    if (xcp->at_list >= xcp->list_count || xcp->at_odt >= xcp->list[xcp->at_list].odts) return NULL;
    const laconic_xcp_odt *odt = &xcp->odt[xcp->list[xcp->at_list].first_odt + xcp->at_odt];
    return xcp->at_entry < odt->entries ? &xcp->entry[odt->first_entry + xcp->at_entry] : NULL;
}

/* An entry must be there when it is written, so that a mistake is found at once. */
static uint8_t write_entry(laconic_node *node, const uint8_t *command) {
    laconic_xcp *xcp = &node->xcp;
    uint8_t bytes[ODT_BYTES];
    const uint8_t size = command[2];
    const uint32_t address = word32(command + 4);
    uint32_t *entry = entry_at(xcp);
    if (entry == NULL) return XCP_SEQUENCE;
    if (xcp->list[xcp->at_list].running) return XCP_DAQ_ACTIVE;
    if (command[1] != NO_BIT || command[3] != 0 || size == 0 || size > ODT_BYTES) return XCP_OUT_OF_RANGE;
    const uint8_t error = laconic_xcp_read(node, address, bytes, size);
    if (error != XCP_DONE) return error;
    *entry = address | (uint32_t)size << ENTRY_ADDRESS_BITS;
    xcp->at_entry++;
    return XCP_DONE;
}

static uint8_t set_mode(laconic_xcp *xcp, const uint8_t *command) {
    if (!is_list(xcp, command + 2) || word16(command + 4) >= LACONIC_XCP_EVENTS) return XCP_OUT_OF_RANGE;
    laconic_xcp_list *list = &xcp->list[command[2]];
    if ((command[1] & ~MODE_STAMPED) != 0) return XCP_MODE_NOT_VALID; /* no stimulation, no frames without number */
    if (command[6] == 0 || command[7] != 0) return XCP_OUT_OF_RANGE;  /* prescaler; all lists have priority 0 */
    if (list->running) return XCP_DAQ_ACTIVE;
    list->stamped = (command[1] & MODE_STAMPED) != 0;
    list->event = command[4];
    list->prescaler = command[6];
    list->has_mode = true;
    return XCP_DONE;
}

/* ------------------------------------------------------------------------------- start and stop -- */

/* Whether all entries of an ODT have been written and fit into its frame. */
static bool fits(const laconic_xcp *xcp, const laconic_xcp_odt *odt, uint32_t room) {
    uint32_t bytes = 0;
    for (uint8_t k = 0; k < odt->entries; k++) {
        const uint32_t size = xcp->entry[odt->first_entry + k] >> ENTRY_ADDRESS_BITS;
        if (size == 0) return false;
        bytes += size;
    }
    return bytes <= room;
}

static bool is_complete(const laconic_xcp *xcp, const laconic_xcp_list *list) {
    for (uint8_t k = 0; k < list->odts; k++) {
        const uint32_t room = k == 0 && list->stamped ? ODT_BYTES - STAMP_BYTES : ODT_BYTES;
        if (!fits(xcp, &xcp->odt[list->first_odt + k], room)) return false;
    }
    return list->has_mode && list->odts > 0;
}

static void start(laconic_xcp_list *list) {
    list->running = true;
    list->count = 0;
}

static uint8_t start_list(laconic_xcp *xcp, const uint8_t *command) {
    if (!is_list(xcp, command + 2)) return XCP_OUT_OF_RANGE;
    laconic_xcp_list *list = &xcp->list[command[2]];
    if (command[1] > 2) return XCP_MODE_NOT_VALID;
    if (command[1] != 0 && !is_complete(xcp, list)) return XCP_DAQ_CONFIG;
    if (command[1] == 0) list->running = false;
    if (command[1] == 1) start(list);
    if (command[1] == 2) list->selected = true;
    xcp->answer.data[1] = list->first_odt;
    xcp->answer.length = 2;
    return XCP_DONE;
}

/* 0: stops all lists; 1: starts the selected ones; 2: stops them. */
static uint8_t start_selected(laconic_xcp *xcp, uint8_t mode) {
    if (mode > 2) return XCP_MODE_NOT_VALID;
    for (uint8_t k = 0; k < xcp->list_count; k++) {
        laconic_xcp_list *list = &xcp->list[k];
        if (mode == 0 || (mode == 2 && list->selected)) list->running = false;
        if (mode == 1 && list->selected) start(list);
        list->selected = false;
    }
    return XCP_DONE;
}

/* --------------------------------------------------------------------------------- descriptions -- */

static uint8_t clock(laconic_node *node) {
    put32(node->xcp.answer.data + 4, stamp_us(node));
    node->xcp.answer.length = 8;
    return XCP_DONE;
}

static uint8_t describe_processor(laconic_xcp *xcp) {
    uint8_t *answer = xcp->answer.data;
    answer[1] = 0x93; /* dynamic lists, prescaler, stamps; an event tells of overload */
    put16(answer + 2, xcp->list_count);
    put16(answer + 4, LACONIC_XCP_EVENTS);
    xcp->answer.length = 8; /* none predefined; each frame begins with the number of its ODT */
    return XCP_DONE;
}

static uint8_t describe_resolution(laconic_xcp *xcp) {
    uint8_t *answer = xcp->answer.data;
    answer[1] = 1;
    answer[2] = ODT_BYTES;
    answer[5] = 0x34; /* stamps have four bytes, in microseconds */
    put16(answer + 6, 1);
    xcp->answer.length = 8;
    return XCP_DONE;
}

/* The cycle as a number below 256 times a power of ten nanoseconds; 0: none such. */
static uint8_t cycle_of(uint64_t ns, uint8_t *unit) {
    for (*unit = 0; ns > 255U && ns % 10U == 0; ns /= 10U) (*unit)++;
    if (ns > 255U) *unit = 0;
    return ns > 255U ? 0U : (uint8_t)ns;
}

static uint8_t describe_event(laconic_node *node, const uint8_t *command) {
    laconic_xcp *xcp = &node->xcp;
    uint8_t *answer = xcp->answer.data;
    const uint16_t event = word16(command + 2);
    if (event >= LACONIC_XCP_EVENTS) return XCP_OUT_OF_RANGE;
    xcp->address = LACONIC_XCP_TEXTS + LACONIC_XCP_TEXT_BYTES * (1U + event);
    answer[1] = 4; /* for measurement */
    answer[2] = LACONIC_XCP_LISTS;
    answer[3] = (uint8_t)strlen(laconic_xcp_texts[1U + event]);
    answer[4] = cycle_of(period_ns[event] == 0 ? step_ns(node) : period_ns[event], &answer[5]);
    xcp->answer.length = 7;
    return XCP_DONE;
}

/* What is not of measurement has been refused before. */
uint8_t laconic_daq_command(laconic_node *node, const uint8_t *command) {
    laconic_xcp *xcp = &node->xcp;
    switch (command[0]) {
    case LACONIC_DAQ_SET_POINTER: return set_pointer(xcp, command);
    case LACONIC_DAQ_WRITE: return write_entry(node, command);
    case LACONIC_DAQ_SET_MODE: return set_mode(xcp, command);
    case LACONIC_DAQ_START_LIST: return start_list(xcp, command);
    case LACONIC_DAQ_START_SELECTED: return start_selected(xcp, command[1]);
    case LACONIC_DAQ_CLOCK: return clock(node);
    case LACONIC_DAQ_PROCESSOR: return describe_processor(xcp);
    case LACONIC_DAQ_RESOLUTION: return describe_resolution(xcp);
    case LACONIC_DAQ_EVENT_INFO: return describe_event(node, command);
    case LACONIC_DAQ_FREE: return free_lists(xcp);
    case LACONIC_DAQ_ALLOC: return alloc_lists(xcp, word16(command + 2));
    case LACONIC_DAQ_ALLOC_ODT: return alloc_odts(xcp, command);
    default: return alloc_entries(xcp, command);
    }
}

/* ------------------------------------------------------------------------------------- samples -- */

static laconic_xcp_packet *room_for(laconic_xcp *xcp, uint8_t number) {
    return &xcp->queue[(xcp->first + xcp->waiting + number) % LACONIC_XCP_QUEUE];
}

/* Writes one ODT's frame behind those that wait; its length, 0: a number is no longer there. */
static uint8_t sample_odt(laconic_node *node, const laconic_xcp_list *list, uint8_t number, uint8_t *frame) {
    const laconic_xcp *xcp = &node->xcp;
    const laconic_xcp_odt *odt = &xcp->odt[list->first_odt + number];
    uint8_t length = 1;
    frame[0] = (uint8_t)(list->first_odt + number);
    if (number == 0 && list->stamped) {
        put32(frame + 1, stamp_us(node));
        length = 1 + STAMP_BYTES;
    }
    for (uint8_t k = 0; k < odt->entries; k++) {
        const uint32_t entry = xcp->entry[odt->first_entry + k];
        const uint32_t address = entry & 0xFFFFFFU, size = entry >> ENTRY_ADDRESS_BITS;
        if (laconic_xcp_read(node, address, frame + length, size) != XCP_DONE) return 0;
        length = (uint8_t)(length + size);
    }
    return length;
}

/* A vehicle that lacks what is measured ends the session of the master. */
static void end_session(laconic_xcp *xcp) {
    laconic_daq_clear(xcp);
    xcp->connected = false;
    xcp->senses = false;
    xcp->ended = true;
}

static void sample(laconic_node *node, const laconic_xcp_list *list) {
    laconic_xcp *xcp = &node->xcp;
    if (list->odts > LACONIC_XCP_QUEUE - xcp->waiting) {
        xcp->overloaded = true;
        return;
    }
    const uint8_t count = list->odts;
    for (uint8_t k = 0; k < count; k++) {
        laconic_xcp_packet *packet = room_for(xcp, k);
        packet->length = sample_odt(node, list, k, packet->data);
        if (packet->length == 0) {
            end_session(xcp);
            return;
        }
    }
    xcp->waiting = (uint8_t)(xcp->waiting + count);
}

/* ---------------------------------------------------------------------------------------- steps -- */

/* Frames of all lists that run, as one instant may make them. */
static uint32_t frames_of_instant(const laconic_xcp *xcp) {
    uint32_t frames = 0;
    for (uint8_t k = 0; k < xcp->list_count; k++)
        if (xcp->list[k].running) frames += xcp->list[k].odts;
    return frames;
}

uint32_t laconic_daq_steps(const laconic_node *node, uint32_t steps) {
    const laconic_xcp *xcp = &node->xcp;
    const uint32_t frames = frames_of_instant(xcp);
    if (frames == 0 || steps == 0) return steps;
    return frames <= (uint32_t)(LACONIC_XCP_QUEUE - xcp->waiting) ? 1U : 0U;
}

void laconic_daq_event(laconic_node *node) {
    laconic_xcp *xcp = &node->xcp;
    xcp->seen_bit = 0;
    for (uint8_t k = 0; k < xcp->list_count; k++) {
        laconic_xcp_list *list = &xcp->list[k];
        if (!list->running || !is_due(node, list->event)) continue;
        list->count++;
        if (list->count < list->prescaler) continue;
        list->count = 0;
        sample(node, list);
    }
}

#endif
