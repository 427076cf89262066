/* Fault campaigns of the node in virtual time; prints a line for each figure.
 *
 *     fault_campaign memory FROM TO SEED none|sum|all   bits FROM to TO of the node's memory, in the order of SEED
 *     fault_campaign bits                               how many there are
 *     fault_campaign power | clocks */
#include "campaigns.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int usage(void) {
    fprintf(stderr, "usage: fault_campaign memory FROM TO SEED none|sum|all | bits | power | clocks\n");
    return 2;
}

static uint8_t checks_of(const char *name) {
    if (strcmp(name, "none") == 0) return 0;
    return strcmp(name, "sum") == 0 ? LACONIC_INTEGRITY_SUM | LACONIC_INTEGRITY_RANGE : LACONIC_INTEGRITY_ALL;
}

int main(int count, char **words) {
    if (count == 6 && strcmp(words[1], "memory") == 0)
        return campaign_memory(strtoull(words[2], NULL, 10), strtoull(words[3], NULL, 10), strtoull(words[4], NULL, 10),
                               checks_of(words[5]));
    if (count != 2) return usage();
    if (strcmp(words[1], "bits") == 0) return printf("bits %zu\n", 8 * sizeof(laconic_node)) < 0;
    if (strcmp(words[1], "power") == 0) return campaign_power();
    if (strcmp(words[1], "clocks") == 0) return campaign_clocks();
    return usage();
}
