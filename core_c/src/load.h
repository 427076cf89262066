/* The load at a heading. */
#ifndef LACONIC_LOAD_H
#define LACONIC_LOAD_H

#include "elementary.h"

/* b of a load that turns. */
void laconic_load_at(real b[3], const laconic_load *load, direction heading);

/* b of any load; the heading is looked at only where a force turns with it. */
static inline void load_now(real b[3], const laconic_load *load, const laconic_heading *heading, real offset_rad) {
    int k;
    if (LACONIC_WITH_WORLD_FORCE && load->turns) {
        laconic_load_at(b, load,
                        laconic_direction_of_turn((laconic_turn)(heading->fraction + laconic_turn_of_angle(offset_rad))));
        return;
    }
    for (k = 0; k < 3; k++) b[k] = load->constant[k];
}

#endif
