/* A robot drives a curve to the left: `pio ci --lib . --board …` builds it for boards whose framework has printf. */
#include <laconic_single.h>
#include <stdio.h>

@robot@
int main(void) {
@main@    return status != LACONIC_SINGLE_OK;
}
