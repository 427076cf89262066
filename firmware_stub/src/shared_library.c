/* Functions for tests and the in-process rig, beside those of the node. */
#include "shared_library.h"

#include "laconic_node/node.h"
#include "laconic_wire.h"

uint32_t laconic_library_node_size(void) { return (uint32_t)sizeof(laconic_node); }

bool laconic_library_node_init(laconic_node *node, uint16_t id_base, bool can_fd, uint32_t nonce_seed,
                               uint32_t now_us) {
    const laconic_node_config config = {id_base, can_fd, laconic_method_by_number, nonce_seed,
                                        laconic_drive_protocol_by_number};
    return laconic_node_init(node, &config, now_us);
}

void laconic_library_inspect(const laconic_node *node, laconic_library_view *view) {
    const laconic_library_view seen = {
        .state = node->state,
        .deaf = node->session.deaf != 0,
        .steps = node->plant.steps,
        .voltage_V = {(double)node->input[0].voltage_V[0], (double)node->input[0].voltage_V[1],
                      (double)node->input[0].voltage_V[2]},
        .counters = node->counters,
    };
    *view = seen;
}

static void try_error(laconic_error_census *census, const uint8_t frame[8], uint64_t error, const uint8_t data_ids[16],
                      uint8_t max_delta) {
    uint8_t data[8];
    const uint8_t mask = LACONIC_E2E_P22_COUNTER_MASK;
    for (unsigned k = 0; k < 8; k++) data[k] = (uint8_t)(frame[k] ^ (error >> (8U * k) & 255U));
    laconic_e2e_receiver receiver = {.known = true, .counter = (uint8_t)((frame[1] - 1U) & mask)};
    const laconic_e2e_ends ends = {LACONIC_E2E_P22_START, data_ids[data[1] & mask]};
    const bool right = laconic_e2e_p22_crc_is_right(data, 8, ends);
    const laconic_e2e_status status = laconic_e2e_check(&receiver, right, data[1] & mask, mask, max_delta);
    uint64_t *counts = (data[1] & mask) == (frame[1] & mask) ? census->counter_kept : census->counter_changed;
    counts[!right ? 0 : laconic_e2e_accepts(status) ? 2 : 1]++;
}

void laconic_library_census(laconic_error_census *census, const uint8_t frame[8], const uint8_t data_ids[16],
                            uint8_t max_delta) {
    for (unsigned i = 0; i < 64; i++) {
        const uint64_t one = (uint64_t)1 << i;
        try_error(census, frame, one, data_ids, max_delta);
        for (unsigned j = i + 1; j < 64; j++) {
            const uint64_t two = one | (uint64_t)1 << j;
            try_error(census, frame, two, data_ids, max_delta);
            for (unsigned k = j + 1; k < 64; k++) try_error(census, frame, two | (uint64_t)1 << k, data_ids, max_delta);
        }
    }
}
