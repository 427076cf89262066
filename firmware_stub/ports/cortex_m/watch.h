/* Whether this image watches its own memory (laconic_node/integrity.h): unless LACONIC_PORT_WATCHES_MEMORY is 0, as for
 * images that must be small. */
#ifndef PORT_WATCH_H
#define PORT_WATCH_H

#include "laconic_node/integrity.h"

#ifndef LACONIC_PORT_WATCHES_MEMORY
#define LACONIC_PORT_WATCHES_MEMORY 1
#endif

#if LACONIC_PORT_WATCHES_MEMORY
static laconic_integrity watch;
static laconic_node_config original;

static inline void port_watch(const laconic_node *node) {
    static const laconic_integrity_limits any_finite_number = {0, 0, 0, 0};
    original = node->config;
    laconic_integrity_begin(&watch, node, &original, &any_finite_number, LACONIC_INTEGRITY_ALL);
}

static inline void port_on_frame(laconic_node *node, const laconic_frame *frame, uint32_t now_us) {
    laconic_integrity_on_frame(&watch, node, frame, now_us);
}

static inline void port_on_tick(laconic_node *node, uint32_t now_us) {
    laconic_integrity_on_tick(&watch, node, now_us);
}

static inline bool port_next_frame(laconic_node *node, laconic_frame *frame) {
    return laconic_integrity_next_frame(&watch, node, frame);
}
#else
static inline void port_watch(const laconic_node *node) { (void)node; }

static inline void port_on_frame(laconic_node *node, const laconic_frame *frame, uint32_t now_us) {
    laconic_node_on_frame(node, frame, now_us);
}

static inline void port_on_tick(laconic_node *node, uint32_t now_us) { laconic_node_on_tick(node, now_us); }

static inline bool port_next_frame(laconic_node *node, laconic_frame *frame) {
    return laconic_node_next_frame(node, frame);
}
#endif

#endif
