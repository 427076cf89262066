/* As much of a C library as core_c/tests/bits/trajectory_hash.c uses, for a module that has none: its <inttypes.h>,
 * <stdio.h> and <string.h> all include this file. */
#ifndef LACONIC_WEB_C_LIBRARY_H
#define LACONIC_WEB_C_LIBRARY_H

#include <stdint.h>

#define PRIx64 "llx"

int printf(const char *format, ...); /* hash.c */

#define memcpy __builtin_memcpy /* instructions of WebAssembly */
#define memset __builtin_memset

#endif
