/* Handshake, and whether a frame is one that the rig sends now: the next command, or the second right motion frame. */
#include "node_internal.h"

#include <string.h>

/* The first HELLO makes the nonce, since without a seed of the port only the instant of this frame differs between two
 * power-ups. Later ones change nothing: a stale HELLO must not disturb a handshake. */
void laconic_node_hello(laconic_node *node, const uint8_t *data, uint32_t now_us) {
    laconic_node_session *session = &node->session;
    if (!laconic_plain_is_right(LACONIC_WIRE_HELLO, data)) {
        count(&node->counters.crc_errors);
        return;
    }
    count(&node->counters.accepted);
    if (!session->has_nonce) session->nonce = laconic_mix(node->config.nonce_seed, now_us);
    session->has_nonce = true;
    session->request = laconic_counter_of(LACONIC_WIRE_HELLO, data);
    node->pending |= BIT_OF(LACONIC_WIRE_IDENTITY) | BIT_OF(LACONIC_WIRE_CHALLENGE);
}

static bool answers(const uint8_t *data, uint32_t nonce) {
    const uint16_t echo = word16(data + 2);
    return echo == (nonce & 0xFFFFU) &&
           laconic_keyed_is_right(LACONIC_WIRE_OPEN, data, nonce, laconic_counter_of(LACONIC_WIRE_OPEN, data));
}

static void begin_session(laconic_node *node, uint32_t number, uint32_t now_us) {
    laconic_node_session *session = &node->session;
    const uint32_t nonce = session->nonce;
    memset(session->count, 0, sizeof session->count);
    session->open = true;
    session->armed = 0;
    session->deaf = 0;
    session->number = number;
    session->key = laconic_mix(number, nonce);
    if (!LACONIC_NODE_DRIVES_ONLY) session->run_key = laconic_run_key(session->key, 0);
    session->last_nonce = nonce;
    session->nonce = laconic_mix(laconic_mix(nonce, number), now_us);
}

/* An OPEN that is repeated because its answer was lost has the nonce before: it is answered, but not executed again. */
void laconic_node_open(laconic_node *node, const uint8_t *data, uint32_t now_us) {
    laconic_node_session *session = &node->session;
    const uint32_t number = word32(data + 4);
    if (session->has_nonce && answers(data, session->nonce)) {
        begin_session(node, number, now_us);
        laconic_node_make_idle(node);
        count(&node->counters.accepted);
    } else if (session->open && number == session->number && answers(data, session->last_nonce)) {
        count(&node->counters.repeated);
    } else {
        count(&node->counters.crc_errors);
        return;
    }
    node->answer[LACONIC_WIRE_OPEN].request = laconic_counter_of(LACONIC_WIRE_OPEN, data);
    node->answer[LACONIC_WIRE_OPEN].command = LACONIC_WIRE_COMMAND_OPEN;
    laconic_node_answer_again(node, LACONIC_WIRE_OPEN);
}

/* Where a frame is counted: STEERING, whose identifier lies among the node's, behind those of all nodes. */
static uint8_t place_of(uint8_t offset) {
    return LACONIC_NODE_WITH_HINGES && offset > LACONIC_WIRE_RIG_OFFSETS ? LACONIC_WIRE_RIG_OFFSETS : offset;
}

/* By how many counts the frame is ahead of the last one of its kind; −1: its protection is wrong. */
static int ahead_of_last(const laconic_node *node, uint8_t offset, const uint8_t *data, uint32_t key) {
    const uint8_t mask = LACONIC_NODE_CAN_FD && laconic_wire[offset].fd ? 255U : 15U;
    const uint32_t last = node->session.count[place_of(offset)];
    const uint32_t ahead = (laconic_counter_of(offset, data) - last) & mask;
    return node->session.open && laconic_keyed_is_right(offset, data, key, last + ahead) ? (int)ahead : -1;
}

static bool refuse(laconic_node *node, int ahead) {
    count(ahead < 0 ? &node->counters.crc_errors : &node->counters.sequence_errors);
    return false;
}

static bool accept(laconic_node *node, uint8_t offset, int ahead) {
    node->session.count[place_of(offset)] += (uint32_t)ahead;
    count(&node->counters.accepted);
    return true;
}

/* The rig waits for each answer, so a new command has the next count. A repeated one means that its answer was lost. */
bool laconic_node_takes_command(laconic_node *node, uint8_t offset, const uint8_t *data) {
    const int ahead = ahead_of_last(node, offset, data, node->session.key);
    if (ahead == 0 && node->session.count[offset] > 0) {
        count(&node->counters.repeated);
        laconic_node_answer_again(node, offset);
        return false;
    }
    if (ahead != 1) return refuse(node, ahead);
    node->answer[offset].request = data[1] & 15U;
    return accept(node, offset, ahead);
}

void laconic_node_begin_run(laconic_node *node) {
    laconic_node_session *session = &node->session;
    if (LACONIC_NODE_DRIVES_ONLY) return;
    session->run_key = laconic_run_key(session->key, session->count[LACONIC_WIRE_CONTROL]);
    session->armed = 0;
    session->deaf = 0;
    memset(&session->count[LACONIC_WIRE_RUN_FIRST], 0, LACONIC_WIRE_RUN_OFFSETS * sizeof session->count[0]);
#if LACONIC_NODE_WITH_HINGES
    session->count[LACONIC_WIRE_RIG_OFFSETS] = 0;
#endif
}

/* A motion frame acts only if the frame before it was right, too, and had the count before. So a single stale frame
 * whose CRC is right by chance does not move the vehicle, and only START restores a lost count. In free run, where
 * frames follow regularly, a few may be lost: then the first one after the gap does not act either. */
bool laconic_node_takes_motion(laconic_node *node, uint8_t offset, const uint8_t *data) {
    laconic_node_session *session = &node->session;
    const int most = node->state == LACONIC_WIRE_STATE_FREE_RUN ? laconic_wire[offset].max_delta : 1;
    const int ahead = ahead_of_last(node, offset, data, session->run_key);
    const uint32_t bit = BIT_OF(offset);
    const bool was_armed = (session->armed & bit) != 0;
    if (ahead == 0) { /* a CAN bus may transmit a frame twice */
        count(&node->counters.repeated);
        return false;
    }
    session->armed |= bit;
    session->deaf &= ~bit;
    if (ahead < 0 || ahead > most) {
        session->armed ^= bit;
        session->deaf |= bit;
        return refuse(node, ahead);
    }
    for (int k = 1; k < ahead; k++) count(&node->counters.lost);
    return accept(node, offset, ahead) && was_armed && ahead == 1;
}
