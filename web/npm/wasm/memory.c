/* Memory for robots: blocks of one size, taken from the module's memory and used again when they are free. */
#include "web.h"

#define PAGE 65536U

extern unsigned char __heap_base; /* set by the linker: the first byte that nothing uses */

typedef union block {
    laconic_web_robot robot;
    union block *next;
} block;

static block *free_blocks;
static uintptr_t next_byte;

static block *new_block(void) {
    if (next_byte == 0) next_byte = ((uintptr_t)&__heap_base + 15U) & ~(uintptr_t)15U;
    const uintptr_t begin = next_byte, end = begin + ((sizeof(block) + 15U) & ~(uintptr_t)15U);
    const uintptr_t room = (uintptr_t)__builtin_wasm_memory_size(0) * PAGE;
    if (end > room && __builtin_wasm_memory_grow(0, (end - room + PAGE - 1) / PAGE) == (size_t)-1) return NULL;
    next_byte = end;
    return (block *)begin;
}

/* A robot with all zero; NULL where the memory ends. */
WEB_EXPORT(laconic_web_new) laconic_web_robot *laconic_web_new(void) {
    block *found = free_blocks;
    if (found != NULL)
        free_blocks = found->next;
    else if ((found = new_block()) == NULL)
        return NULL;
    __builtin_memset(found, 0, sizeof *found);
    return &found->robot;
}

WEB_EXPORT(laconic_web_free) void laconic_web_free(laconic_web_robot *robot) {
    block *freed = (block *)robot;
    freed->next = free_blocks;
    free_blocks = freed;
}
