#include "load.h"

vector laconic_turned_load(const laconic_load *load, const laconic_heading *heading, real offset_rad) {
    const laconic_turn turn = (laconic_turn)(heading->fraction + laconic_turn_of_angle(offset_rad));
    return load_at(load, laconic_direction_of_turn(turn));
}
