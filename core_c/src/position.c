#include "heading.h"

void laconic_position(const laconic_state *state, laconic_real *x_m, laconic_real *y_m, laconic_real *heading_rad) {
    *x_m = state->x_m.value;
    *y_m = state->y_m.value;
    *heading_rad = heading_unwrapped(&state->heading);
}
