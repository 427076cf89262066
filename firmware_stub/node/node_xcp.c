/* The slave of XCP: a master's session and its commands. */
#include "node_internal.h"

#if LACONIC_NODE_WITH_XCP

#include "laconic_node/crc.h"

#include <string.h>

/* Codes of commands, and packets of the slave. */
enum {
    CONNECT = 0xFF,
    DISCONNECT = 0xFE,
    GET_STATUS = 0xFD,
    SYNCH = 0xFC,
    GET_COMM_MODE_INFO = 0xFB,
    GET_ID = 0xFA,
    SET_MTA = 0xF6,
    UPLOAD = 0xF5,
    SHORT_UPLOAD = 0xF4,
    BUILD_CHECKSUM = 0xF3,
    DOWNLOAD = 0xF0,
    SET_CAL_PAGE = 0xEB,
    GET_CAL_PAGE = 0xEA,
    COPY_CAL_PAGE = 0xE4,
    PACKET_ERROR = 0xFE,
    PACKET_EVENT = 0xFD,
    EVENT_DAQ_OVERLOAD = 0x06,
    EVENT_SESSION_TERMINATED = 0x07
};

enum { CTO_BYTES = 8, MOST_UPLOADED = 7, CRC_32 = 0x09, SUM_BYTES = 4 };

/* ------------------------------------------------------------------------------------ commands -- */

static uint8_t connect(laconic_xcp *xcp, const uint8_t *command) {
    uint8_t *answer = xcp->answer.data;
    if (command[1] != 0) return XCP_OUT_OF_RANGE;
    laconic_daq_clear(xcp);
    xcp->connected = true;
    xcp->overloaded = false;
    xcp->ended = false;
    xcp->senses = false;
    xcp->address = 0;
    xcp->part_address = 0;
    answer[1] = 0x05;      /* calibration and pages; measurement */
    answer[2] = 0x80;      /* little-endian bytes; GET_COMM_MODE_INFO gives more */
    answer[3] = CTO_BYTES; /* of a command, and of a sample */
    put16(answer + 4, CTO_BYTES);
    answer[6] = 1; /* versions of protocol and transport */
    answer[7] = 1;
    xcp->answer.length = 8;
    return XCP_DONE;
}

static uint8_t disconnect(laconic_xcp *xcp) {
    laconic_daq_clear(xcp);
    xcp->connected = false;
    xcp->senses = false;
    return XCP_DONE;
}

static uint8_t get_status(laconic_xcp *xcp) {
    xcp->answer.data[1] = laconic_daq_runs(xcp) ? 0x40U : 0U;
    xcp->answer.length = 6; /* nothing is protected */
    return XCP_DONE;
}

/* No block mode, no interleaved commands; the version of the slave is that of the wire. */
static uint8_t get_modes(laconic_xcp *xcp) {
    xcp->answer.data[7] = LACONIC_WIRE_VERSION << 4;
    xcp->answer.length = 8;
    return XCP_DONE;
}

/* ASCII text or name of the A2L file; of other kinds there is none, which a length of 0 tells. */
static uint8_t get_id(laconic_xcp *xcp, const uint8_t *command) {
    put32(xcp->answer.data + 4, command[1] <= 1 ? (uint32_t)strlen(laconic_xcp_texts[0]) : 0U);
    xcp->answer.length = 8;
    xcp->address = LACONIC_XCP_TEXTS;
    return XCP_DONE;
}

static uint8_t set_address(laconic_xcp *xcp, const uint8_t *command) {
    if (command[3] != 0) return XCP_OUT_OF_RANGE; /* no extension */
    xcp->address = word32(command + 4);
    return XCP_DONE;
}

static uint8_t upload(laconic_node *node, uint8_t count) {
    laconic_xcp *xcp = &node->xcp;
    if (count == 0 || count > MOST_UPLOADED) return XCP_OUT_OF_RANGE;
    const uint8_t error = laconic_xcp_read(node, xcp->address, xcp->answer.data + 1, count);
    if (error != XCP_DONE) return error;
    xcp->address += count;
    xcp->answer.length = (uint8_t)(1U + count);
    return XCP_DONE;
}

static uint8_t short_upload(laconic_node *node, const uint8_t *command) {
    const uint8_t error = set_address(&node->xcp, command);
    return error == XCP_DONE ? upload(node, command[1]) : error;
}

static uint8_t build_checksum(laconic_node *node, const uint8_t *command) {
    laconic_xcp *xcp = &node->xcp;
    uint8_t bytes[SUM_BYTES];
    const uint32_t size = word32(command + 4);
    uint32_t sum = LACONIC_CRC32_START;
    xcp->answer.length = 8;
    put32(xcp->answer.data + 4, LACONIC_XCP_SEGMENT); /* in an answer that refuses it, the largest block */
    if (size == 0 || size > LACONIC_XCP_SEGMENT) return XCP_OUT_OF_RANGE;
    for (uint32_t offset = 0; offset < size; offset += SUM_BYTES) {
        const uint32_t count = size - offset < SUM_BYTES ? size - offset : SUM_BYTES;
        const uint8_t error = laconic_xcp_read(node, xcp->address + offset, bytes, count);
        xcp->answer.length = error == XCP_DONE ? 8 : 2;
        if (error != XCP_DONE) return error;
        sum = laconic_crc32(sum, bytes, count);
    }
    xcp->address += size;
    xcp->answer.data[1] = CRC_32;
    put32(xcp->answer.data + 4, sum ^ LACONIC_CRC32_END);
    return XCP_DONE;
}

/* Fewest bytes of a command; 0: there is none such. */
static uint8_t fewest_bytes(uint8_t code) {
    static const uint8_t fewest[][2] = {{CONNECT, 2},
                                        {DISCONNECT, 1},
                                        {GET_STATUS, 1},
                                        {SYNCH, 1},
                                        {GET_COMM_MODE_INFO, 1},
                                        {GET_ID, 2},
                                        {SET_MTA, 8},
                                        {UPLOAD, 2},
                                        {SHORT_UPLOAD, 8},
                                        {BUILD_CHECKSUM, 8},
                                        {DOWNLOAD, 3},
                                        {SET_CAL_PAGE, 4},
                                        {GET_CAL_PAGE, 3},
                                        {COPY_CAL_PAGE, 5},
                                        {LACONIC_DAQ_SET_POINTER, 6},
                                        {LACONIC_DAQ_WRITE, 8},
                                        {LACONIC_DAQ_SET_MODE, 8},
                                        {LACONIC_DAQ_START_LIST, 4},
                                        {LACONIC_DAQ_START_SELECTED, 2},
                                        {LACONIC_DAQ_CLOCK, 1},
                                        {LACONIC_DAQ_PROCESSOR, 1},
                                        {LACONIC_DAQ_RESOLUTION, 1},
                                        {LACONIC_DAQ_EVENT_INFO, 4},
                                        {LACONIC_DAQ_FREE, 1},
                                        {LACONIC_DAQ_ALLOC, 4},
                                        {LACONIC_DAQ_ALLOC_ODT, 5},
                                        {LACONIC_DAQ_ALLOC_ENTRY, 6}};
    for (size_t k = 0; k < sizeof fewest / sizeof fewest[0]; k++)
        if (fewest[k][0] == code) return fewest[k][1];
    return 0;
}

static uint8_t carry_out(laconic_node *node, const uint8_t *command) {
    laconic_xcp *xcp = &node->xcp;
    switch (command[0]) {
    case CONNECT: return connect(xcp, command);
    case DISCONNECT: return disconnect(xcp);
    case GET_STATUS: return get_status(xcp);
    case SYNCH: return XCP_SYNCH;
    case GET_COMM_MODE_INFO: return get_modes(xcp);
    case GET_ID: return get_id(xcp, command);
    case SET_MTA: return set_address(xcp, command);
    case UPLOAD: return upload(node, command[1]);
    case SHORT_UPLOAD: return short_upload(node, command);
    case BUILD_CHECKSUM: return build_checksum(node, command);
    case DOWNLOAD: return laconic_xcp_write(node, command + 2, command[1]);
    case SET_CAL_PAGE: return laconic_xcp_set_page(node, command);
    case GET_CAL_PAGE: return laconic_xcp_get_page(xcp, command);
    case COPY_CAL_PAGE: return laconic_xcp_copy_page(node, command);
    default: return laconic_daq_command(node, command);
    }
}

static uint8_t answer_to(laconic_node *node, const uint8_t *command, uint8_t length) {
    const uint8_t fewest = fewest_bytes(command[0]);
    if (fewest == 0) return XCP_COMMAND_UNKNOWN;
    const bool is_cut = length < fewest || (command[0] == DOWNLOAD && length < 2 + command[1]);
    return is_cut ? XCP_SYNTAX : carry_out(node, command);
}

/* --------------------------------------------------------------------------------------- calls -- */

void laconic_xcp_on_frame(laconic_node *node, const laconic_frame *frame) {
    laconic_xcp *xcp = &node->xcp;
    uint8_t command[CTO_BYTES] = {0};
    if (frame->remote || frame->fd || frame->length == 0 || frame->length > CTO_BYTES) {
        count(&node->counters.malformed);
        return;
    }
    memcpy(command, frame->data, frame->length);
    if (!xcp->connected && command[0] != CONNECT) return; /* a slave without a master is silent */
    memset(&xcp->answer, 0, sizeof xcp->answer);
    xcp->answer.length = 1;
    xcp->answer.data[0] = 0xFF;
    xcp->seen_bit = 0;
    const uint8_t error = answer_to(node, command, frame->length);
    if (error != XCP_DONE) {
        xcp->answer.data[0] = PACKET_ERROR;
        xcp->answer.data[1] = error;
        if (xcp->answer.length < 2) xcp->answer.length = 2;
    }
    xcp->answers = true;
}

static laconic_xcp_packet event_packet(uint8_t event, bool *is_waiting) {
    const laconic_xcp_packet packet = {2, {PACKET_EVENT, event}};
    *is_waiting = false;
    return packet;
}

/* Answers first, then events, then samples. */
static bool next_packet(laconic_xcp *xcp, laconic_xcp_packet *packet) {
    if (xcp->answers) {
        *packet = xcp->answer;
        xcp->answers = false;
    } else if (xcp->ended) {
        *packet = event_packet(EVENT_SESSION_TERMINATED, &xcp->ended);
    } else if (xcp->overloaded) {
        *packet = event_packet(EVENT_DAQ_OVERLOAD, &xcp->overloaded);
    } else if (xcp->waiting > 0) {
        *packet = xcp->queue[xcp->first];
        xcp->first = (uint8_t)((xcp->first + 1U) % LACONIC_XCP_QUEUE);
        xcp->waiting--;
    } else {
        return false;
    }
    return true;
}

bool laconic_xcp_next_frame(laconic_node *node, laconic_frame *frame) {
    laconic_xcp_packet packet;
    if (!next_packet(&node->xcp, &packet)) return false;
    frame->id = (uint32_t)node->config.id_base + LACONIC_WIRE_XCP_RESPONSE;
    frame->length = packet.length;
    frame->extended = false;
    frame->remote = false;
    frame->fd = false;
    frame->bit_rate_switch = false;
    memcpy(frame->data, packet.data, sizeof packet.data);
    return true;
}

#endif
