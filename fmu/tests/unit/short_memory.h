/* The glue's memory in the tests: it is compiled with malloc, calloc and free of its own, which can run out. */
#ifndef SHORT_MEMORY_H
#define SHORT_MEMORY_H

/* So many allocations more succeed, then none; negative: all. */
extern int short_memory_left;

/* Allocated and not freed. */
extern int short_memory_blocks;

#endif
