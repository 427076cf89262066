/* What a board makes of double precision, by semihosting: the self-test, check_double.c, and, where LACONIC_HASH is
 * defined, trajectory_hash.c, whose main() the build renames. */
#include <stdarg.h>

#include "bench_board.h"
#include "laconic/laconic.h"

int check_double(void (*tell)(const char *line));
int laconic_trajectory_hash(void);

static void tell(const char *line) {
    board_write(line);
    board_write("\n");
}

#ifdef LACONIC_HASH
/* trajectory_hash.c prints one number. */
int printf(const char *format, ...) {
    uint64_t hash;
    va_list given;
    (void)format;
    va_start(given, format);
    hash = va_arg(given, uint64_t);
    va_end(given);
    board_write_bits("hash", &hash, sizeof hash);
    return 0;
}
#endif

int main(void) {
    tell(laconic_arithmetic_text(laconic_self_test()));
    check_double(tell);
#ifdef LACONIC_HASH
    return laconic_trajectory_hash();
#else
    return 0;
#endif
}
