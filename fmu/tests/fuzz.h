/* Random use of the whole C interface, valid and not. Every choice comes from the bytes. */
#ifndef LACONIC_FMU_FUZZ_H
#define LACONIC_FMU_FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* Plays one sequence of calls; crashes, or a sanitizer speaks, when something is wrong. */
void fuzz_one(const uint8_t *bytes, size_t size);

#endif
