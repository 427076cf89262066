/* What the two files of a batch share. */
#ifndef LACONIC_BATCH_BLOCK_H
#define LACONIC_BATCH_BLOCK_H

#include "laconic/batch.h"

#include "../src/common.h"
#include "lanes_width.h"

/* Some lanes in a row of `order`, stepped together. */
typedef struct laconic_batch_block {
    lanes_block lanes;
    lanes_method method;
    int32_t way;          /* of its kinds: lanes of one way can share a block                  */
    int32_t first, count; /* in `order`                                                    */
    int32_t wheel_count;
    bool has_refused; /* some lane's status is not OK                                  */
    bool in_a_row;    /* its lanes follow each other, so that its numbers need no copy */
} laconic_batch_block;

/* Outputs follow the input. */
#define ROW_OUTPUTS(wheel_count) ROW_VOLTAGE(wheel_count)
#define ROW_COUNT(wheel_count) (ROW_OUTPUTS(wheel_count) + 4)

static inline int32_t lanes_of_width(const struct lanes_width *width) { return width != NULL ? width->lanes : 1; }

#endif
