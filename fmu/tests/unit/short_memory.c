/* malloc, calloc and free of the glue: they run out where a test wants it, and what is not freed is counted. */
#include "short_memory.h"

#include <stdlib.h>

int short_memory_left = -1;
int short_memory_blocks = 0;
size_t short_memory_asked = 0;

void *short_malloc(size_t size);
void *short_calloc(size_t count, size_t size);
void short_free(void *block);

static int is_there(void) {
    if (short_memory_left > 0) return short_memory_left--;
    return short_memory_left;
}

static void *counted(void *block) {
    short_memory_blocks += block != NULL;
    return block;
}

void *short_malloc(size_t size) { return is_there() ? counted(malloc(size)) : NULL; }

void *short_calloc(size_t count, size_t size) {
    short_memory_asked = count * size;
    return is_there() ? counted(calloc(count, size)) : NULL;
}

void short_free(void *block) {
    short_memory_blocks -= block != NULL;
    free(block);
}
