/* Which registers an x86-64 processor has, and its operating system saves. By instructions, since not every compiler's
 * library brings what __builtin_cpu_supports() calls. */
#ifndef LACONIC_PROCESSOR_H
#define LACONIC_PROCESSOR_H

#include <stdbool.h>
#include <stdint.h>

typedef struct processor_answer {
    uint32_t eax, ebx, ecx, edx;
} processor_answer;

static inline processor_answer processor_says(uint32_t leaf) {
    processor_answer a;
    __asm__ volatile("cpuid" : "=a"(a.eax), "=b"(a.ebx), "=c"(a.ecx), "=d"(a.edx) : "a"(leaf), "c"(0));
    return a;
}

/* All of these registers are saved when threads change. Precondition: OSXSAVE. */
static inline bool processor_saves(uint32_t registers) {
    uint32_t low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return (low & registers) == registers;
}

#define PROCESSOR_OSXSAVE_AND_AVX (UINT32_C(3) << 27) /* leaf 1, ecx */
#define PROCESSOR_AVX2 (UINT32_C(1) << 5)             /* leaf 7, ebx */
#define PROCESSOR_AVX512_F_DQ_VL (UINT32_C(1) << 16 | UINT32_C(1) << 17 | UINT32_C(1) << 31)
#define PROCESSOR_SAVES_YMM UINT32_C(0x06)
#define PROCESSOR_SAVES_ZMM UINT32_C(0xe6)

static inline bool processor_has(uint32_t features, uint32_t registers) {
    if (processor_says(0).eax < 7) return false;
    if ((processor_says(1).ecx & PROCESSOR_OSXSAVE_AND_AVX) != PROCESSOR_OSXSAVE_AND_AVX) return false;
    return processor_saves(registers) && (processor_says(7).ebx & features) == features;
}

#endif
