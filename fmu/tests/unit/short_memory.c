/* malloc and calloc of the glue, which run out where a test wants it. */
#include "short_memory.h"

#include <stdlib.h>

int short_memory_left = -1;

void *short_malloc(size_t size);
void *short_calloc(size_t count, size_t size);

static int is_there(void) {
    if (short_memory_left > 0) return short_memory_left--;
    return short_memory_left;
}

void *short_malloc(size_t size) { return is_there() ? malloc(size) : NULL; }

void *short_calloc(size_t count, size_t size) { return is_there() ? calloc(count, size) : NULL; }
