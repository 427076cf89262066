/* bench-count STEPS: takes that many steps and prints the state, for counting instructions as I(2n) − I(n). */
#include "bench.h"

#include <stdio.h>
#include <stdlib.h>

static void write_bits(const char *name, const void *bytes, size_t size) {
    const unsigned char *from = (const unsigned char *)bytes + size;
    printf("%s ", name);
    while (size-- > 0) printf("%02x", *--from);
    printf("\n");
}

int main(int argc, char **argv) {
    const uint32_t steps = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 1000U;
    bench_reset();
    const laconic_status status = bench_run(steps);
    const laconic_state *state = bench_state();
    for (int k = 0; k < 3; k++) write_bits("zeta", &state->zeta[k].value, sizeof(laconic_real));
    write_bits("x", &state->x_m.value, sizeof(laconic_real));
    write_bits("y", &state->y_m.value, sizeof(laconic_real));
    write_bits("heading", &state->heading.fraction, sizeof(laconic_turn));
    printf("status %d\n", (int)status);
    return status != LACONIC_OK;
}
