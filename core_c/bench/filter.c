/* Takes a filter through the recorded readings. */
#include "filter.h"

static laconic_filter filter;

const char *const bench_part_names[BENCH_PARTS] = {"predict", "encoders", "yaw_rate"};

laconic_status bench_filter_start(void) {
    return laconic_filter_start(&filter, &laconic_scene_model, &bench_filter_settings, &laconic_scene_start);
}

static laconic_status predict(const bench_reading *now) {
    laconic_input held = {0};
    for (int32_t i = 0; i < laconic_scene_model.wheel_count; i++) held.voltage_V[i] = now->voltage_V[i];
    return laconic_filter_predict(&filter, &laconic_scene_model, &laconic_scene_integrator, &held);
}

laconic_status bench_part(uint32_t part, uint32_t cycle) {
    const bench_reading *now = &bench_readings[cycle];
    if (part == 0) return predict(now);
    if (part == 1) return laconic_filter_encoders(&filter, &laconic_scene_model, now->turned_rad, NULL);
    return laconic_filter_yaw_rate(&filter, &laconic_scene_model, now->yaw_rate_rad_per_s, NULL);
}

void bench_write_filter(write_bits write) {
    write_state(write, &filter.state);
    write("bias", &filter.bias_rad_per_s, sizeof filter.bias_rad_per_s);
    for (int32_t i = 0; i < filter.errors; i++) {
        write("variance", &filter.covariance.diagonal[i], sizeof(laconic_real));
        for (int32_t j = i + 1; j < filter.errors; j++)
            write("covariance", &filter.covariance.upper[i][j], sizeof(laconic_real));
    }
}
