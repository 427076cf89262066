/* A robot drives a curve to the left. */
#include <laconic_single.h>
#include <stdio.h>

@robot@
int main(void) {
@main@    return status != LACONIC_SINGLE_OK;
}
