/* A robot drives a curve to the left; needs printf, as of a retargeted I/O component. */
#include <laconic_single.h>
#include <stdio.h>

@robot@
int main(void) {
@main@    return status != LACONIC_SINGLE_OK;
}
