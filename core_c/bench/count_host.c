/* count STEPS: takes that many steps and writes the state; a step takes (I(2n) − I(n))/n instructions. */
#include "bench.h"

#include <stdio.h>
#include <stdlib.h>

static void write_line(const char *name, const void *bytes, uint32_t size) {
    const unsigned char *from = (const unsigned char *)bytes + size; /* most significant first: little-endian */
    printf("%s ", name);
    while (size-- > 0) printf("%02x", *--from);
    printf("\n");
}

int main(int argc, char **argv) {
    const uint32_t steps = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 1000U;
    bench_reset();
    const laconic_status status = bench_run(steps);
    write_state(write_line, bench_state());
    printf("status %d\n", (int)status);
    return status != LACONIC_OK;
}
