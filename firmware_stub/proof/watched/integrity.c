/* A node watched for memory that changes between two calls, for Frama-C's analyser: any memory, any calls at any times.
 * The node's own functions, which entries of their own follow, stand here as what they may leave: any node, with counts
 * as they set them. */
#include "laconic_node/integrity.h"

#include "node_internal.h"

#include "../any_frame.h"

static laconic_node node;
static laconic_node_config config;
static laconic_integrity integrity;

/* Any bytes, but for the pointers: a changed one is compared with the original before it is used. */
static void any_node(laconic_node *of) {
    Frama_C_make_unknown((char *)of, sizeof *of);
    of->config.id_base = (uint16_t)ANY_WORD();
    of->config.can_fd = ANY_BOOL();
    of->config.method = ANY_BOOL() ? laconic_method_by_number : NULL;
    of->config.nonce_seed = ANY_WORD();
    of->plant.friction.acts = ANY_BOOL();
}

bool laconic_node_init(laconic_node *of, const laconic_node_config *by, uint32_t now_us) {
    (void)by;
    (void)now_us;
    any_node(of);
    return ANY_BOOL();
}

void laconic_node_fail(laconic_node *of, const laconic_refusal *why, uint8_t request) {
    (void)why;
    (void)request;
    any_node(of);
}

void laconic_node_on_frame(laconic_node *of, const laconic_frame *got, uint32_t now_us) {
    (void)got;
    (void)now_us;
    any_node(of);
}

void laconic_node_on_tick(laconic_node *of, uint32_t now_us) {
    (void)now_us;
    any_node(of);
}

bool laconic_node_next_frame(laconic_node *of, laconic_frame *to) {
    any_node(of);
    Frama_C_make_unknown((char *)to, sizeof *to);
    return ANY_BOOL();
}

void prove_integrity(void) {
    laconic_integrity_limits limits;
    ANYTHING(limits);
    config.id_base = (uint16_t)ANY_WORD();
    config.can_fd = ANY_BOOL();
    config.method = laconic_method_by_number;
    config.nonce_seed = ANY_WORD();
    any_node(&node);
    laconic_integrity_begin(&integrity, &node, &config, &limits, Frama_C_unsigned_char_interval(0, 255));
    while (ANY_BOOL()) {
        any_frame();
        any_node(&node);
        laconic_integrity_on_frame(&integrity, &node, &frame, ANY_WORD());
        any_node(&node);
        laconic_integrity_on_tick(&integrity, &node, ANY_WORD());
        any_node(&node);
        (void)laconic_integrity_next_frame(&integrity, &node, &frame);
    }
}
