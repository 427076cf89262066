/* The glue's memory in the tests: it is compiled with malloc, calloc and free of its own, which can run out. */
#ifndef SHORT_MEMORY_H
#define SHORT_MEMORY_H

#include <stddef.h>

/* So many allocations more succeed, then none; negative: all. */
extern int short_memory_left;

/* Allocated and not freed. */
extern int short_memory_blocks;

/* Bytes that the last calloc asked for. */
extern size_t short_memory_asked;

#endif
