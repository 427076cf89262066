/* The fault campaigns, on the rig of the node's tests. */
#ifndef LACONIC_CAMPAIGNS_H
#define LACONIC_CAMPAIGNS_H

#include "rig.h"

int campaign_memory(uint64_t from, uint64_t to, uint64_t seed, uint8_t checks);
int campaign_power(void);
int campaign_clocks(void);

#endif
