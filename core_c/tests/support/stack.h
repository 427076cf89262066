/* What a call finds on the stack, so that a number that it reads without having set it is seen. */
#ifndef LACONIC_TEST_STACK_H
#define LACONIC_TEST_STACK_H

#include <stddef.h>
#include <stdint.h>

#define ALL_NAN 0xFF /* in every byte: NaN in every number */

static inline void fill_below(uint8_t byte) {
    volatile uint8_t below[48 * 1024];
    for (size_t i = 0; i < sizeof below; i++) below[i] = byte;
}

/* By a pointer that no compiler looks through: in the caller's own frame the bytes would lie elsewhere. */
static inline void fill_stack(uint8_t byte) {
    void (*volatile opaque)(uint8_t) = fill_below;
    opaque(byte);
}

#endif
