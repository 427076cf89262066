/* What the two files of a batch share. */
#ifndef LACONIC_BATCH_BLOCK_H
#define LACONIC_BATCH_BLOCK_H

#include "common.h"

#include "laconic/batch.h"
#include "lanes_width.h"

/* Outputs follow the input. */
#define ROW_OUTPUTS(wheel_count) ROW_VOLTAGE(wheel_count)
#define ROW_COUNT(wheel_count) (ROW_OUTPUTS(wheel_count) + 4)

static inline int32_t lanes_of_width(const struct lanes_width *width) { return width != NULL ? width->lanes : 1; }

/* From a number of a block's state to the next. */
static inline size_t state_stride(const struct lanes_width *width) {
    return (size_t)lanes_of_width(width) * sizeof(laconic_real);
}

#endif
