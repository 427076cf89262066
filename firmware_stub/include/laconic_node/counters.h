/* Counts of frames and faults since the last RESET. */
#ifndef LACONIC_NODE_COUNTERS_H
#define LACONIC_NODE_COUNTERS_H

#include <stdint.h>

/* Each stops at 65535. In the order of the frame COUNTERS, three to a page. */
typedef struct laconic_node_counters {
    uint16_t crc_errors, sequence_errors, repeated, lost, malformed, late_periods, accepted, refused, overrange;
} laconic_node_counters;

#endif
