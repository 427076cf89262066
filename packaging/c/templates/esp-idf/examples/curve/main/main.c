/* A robot drives a curve to the left. */
#include <laconic_single.h>
#include <stdio.h>

@robot@
void app_main(void);

void app_main(void) {
@main@    if (status != LACONIC_SINGLE_OK) printf("%s\n", laconic_single_status_name(status));
}
