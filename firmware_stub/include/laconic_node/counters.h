/* What came in and went wrong since the last RESET. */
#ifndef LACONIC_NODE_COUNTERS_H
#define LACONIC_NODE_COUNTERS_H

#include <stdint.h>

/* All of them stay at 65535. In the order of COUNTERS, three to a page. */
typedef struct laconic_node_counters {
    uint16_t crc_errors, sequence_errors, repeated, lost, malformed, late_periods, accepted, refused, overrange;
} laconic_node_counters;

#endif
