/* count_casadi STEPS: that many steps of CasADi's RK4, for counting instructions as I(2n) − I(n). */
#include <stdlib.h>

void peer_reset(void);
void peer_run(long steps, long steps_per_second);

int main(int argc, char **argv) {
    peer_reset();
    peer_run(argc > 1 ? strtol(argv[1], NULL, 10) : 1000, STEPS_PER_SECOND);
    return 0;
}
