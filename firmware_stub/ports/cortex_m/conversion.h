/* Numbers of 64 bits in single precision, as the compiler's library makes them. */
#ifndef CONVERSION_H
#define CONVERSION_H

#include <stdbool.h>
#include <stdint.h>

/* The bits of the nearest number in single precision; of two that are as near, the even one. */
uint32_t port_single_bits(uint64_t whole);

#endif
