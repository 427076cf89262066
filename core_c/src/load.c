#include "load.h"

void laconic_load_of(laconic_load *load, const laconic_model *model, const laconic_input *input) {
    load_of(load, model, input);
}
