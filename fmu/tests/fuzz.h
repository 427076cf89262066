/* Random calls of the whole C interface, valid and invalid. Every choice comes from the bytes. */
#ifndef LACONIC_FMU_FUZZ_H
#define LACONIC_FMU_FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* Makes one sequence of calls; the program crashes, or a sanitizer ends it, when something is wrong. */
void fuzz_one(const uint8_t *bytes, size_t size);

#endif
