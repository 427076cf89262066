/* The node between any frames at any times, for Frama-C's analyser. The functions by which it loads, starts and steps
 * a vehicle have entries of their own (`loader`, those of the core); here they stand as what they may leave: any
 * numbers, with counts and flags as they set them. */
#include "laconic_node/node.h"

#include "any_frame.h"

#define MOST_TURNS ((1LL << 62) + ((1LL << 62) - 2))

static laconic_node node;

static laconic_status any_status(laconic_refusal *why) {
    const laconic_status status = (laconic_status)Frama_C_interval(0, LACONIC_STATUS_COUNT - 1);
    if (why != NULL && status != LACONIC_OK) {
        Frama_C_make_unknown((char *)why, sizeof *why);
        why->status = status;
    }
    return status;
}

static void any_motion(laconic_plant *plant) {
    Frama_C_make_unknown((char *)&plant->state, sizeof plant->state);
    Frama_C_make_unknown((char *)&plant->slip, sizeof plant->slip);
    Frama_C_make_unknown((char *)&plant->steps, sizeof plant->steps);
    plant->state.heading.turns = Frama_C_long_long_interval(-MOST_TURNS - 1, MOST_TURNS);
}

laconic_status laconic_plant_start(laconic_plant *plant, const laconic_vehicle *vehicle, const laconic_method *method,
                                   laconic_real step_s, const laconic_start *start, laconic_refusal *why) {
    const laconic_status status = any_status(why);
    (void)method;
    (void)start;
    if (status != LACONIC_OK) return status;
    if (!(step_s > 0 && step_s <= LACONIC_REAL_MAX)) return LACONIC_NOT_POSITIVE;
    plant->vehicle = *vehicle;
    Frama_C_make_unknown((char *)&plant->model, sizeof plant->model);
    plant->model.wheel_count = Frama_C_interval(0, LACONIC_MAX_WHEELS);
    plant->model.dof = Frama_C_interval(1, 3);
    plant->model.rotated_twice = ANY_BOOL();
    plant->model.sloped = ANY_BOOL();
    plant->friction.acts = ANY_BOOL();
    plant->friction.slips = ANY_BOOL();
    plant->friction.wheel_count = plant->model.wheel_count;
    plant->friction.point_count = Frama_C_interval(0, LACONIC_SLIP_POINTS);
    plant->integrator.step_s = step_s;
    any_motion(plant);
    return status;
}

laconic_status laconic_plant_restart(laconic_plant *plant, const laconic_start *start, laconic_refusal *why) {
    (void)start;
    any_motion(plant);
    return any_status(why);
}

laconic_status laconic_plant_run(laconic_plant *plant, const laconic_input *held, uint64_t steps,
                                 laconic_refusal *why) {
    (void)held;
    (void)steps;
    any_motion(plant);
    return any_status(why);
}

laconic_status laconic_plant_run_sampled(laconic_plant *plant, const laconic_input samples[3], laconic_refusal *why) {
    (void)samples;
    any_motion(plant);
    return any_status(why);
}

static void any_of_wheels(laconic_real *numbers, const laconic_plant *plant) {
    for (int32_t i = 0; i < plant->model.wheel_count; i++) ANYTHING(numbers[i]);
}

void laconic_plant_wheel_speeds(const laconic_plant *plant, laconic_real *speed_rad_per_s) {
    any_of_wheels(speed_rad_per_s, plant);
}

void laconic_plant_wheel_angles(const laconic_plant *plant, laconic_real *angle_rad) {
    any_of_wheels(angle_rad, plant);
}

laconic_real laconic_plant_energy_J(const laconic_plant *plant) {
    laconic_real energy;
    (void)plant;
    ANYTHING(energy);
    return energy;
}

/* ----------------------------------------------------------------------------------------- sensors -- */

/* Each step adds less than 2^32 counts, so an encoder needs 2^31 steps to come here. */
#define MOST_COUNTS (1LL << 62)

static void any_watched(laconic_sensors *sensors) {
    Frama_C_make_unknown((char *)sensors->encoder, sizeof sensors->encoder);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++)
        sensors->encoder[i].count = Frama_C_long_long_interval(-MOST_COUNTS, MOST_COUNTS);
    Frama_C_make_unknown((char *)sensors->sample, sizeof sensors->sample);
}

laconic_status laconic_sensor_settings_check(const laconic_sensor_settings *settings, int32_t wheel_count,
                                             laconic_refusal *why) {
    (void)settings;
    (void)wheel_count;
    return any_status(why);
}

laconic_status laconic_sensors_start(laconic_sensors *sensors, const laconic_sensor_settings *settings,
                                     const laconic_plant *plant, laconic_refusal *why) {
    (void)plant;
    sensors->settings = *settings;
    sensors->settings.encoder_wrap = Frama_C_interval(0, 2147483647); /* what the check lets pass */
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++)
        sensors->settings.encoder[i].counts_per_turn = Frama_C_interval(0, 2147483647);
    any_watched(sensors);
    return any_status(why);
}

laconic_status laconic_sensors_run(laconic_sensors *sensors, laconic_plant *plant, const laconic_input *held,
                                   uint64_t steps, laconic_refusal *why) {
    any_watched(sensors);
    return laconic_plant_run(plant, held, steps, why);
}

laconic_status laconic_sensors_run_sampled(laconic_sensors *sensors, laconic_plant *plant,
                                           const laconic_input samples[3], laconic_refusal *why) {
    any_watched(sensors);
    return laconic_plant_run_sampled(plant, samples, why);
}

void laconic_sensors_read(laconic_sensor_outputs *outputs, const laconic_sensors *sensors, const laconic_plant *plant,
                          const laconic_input *input) {
    (void)sensors;
    (void)plant;
    (void)input;
    Frama_C_make_unknown((char *)outputs, sizeof *outputs);
}

void laconic_imu_read(const laconic_sensors *sensors, laconic_real step_s, laconic_real acceleration_m_per_s2[2],
                      laconic_real *yaw_rate_rad_per_s) {
    (void)sensors;
    (void)step_s;
    ANYTHING(acceleration_m_per_s2[0]);
    ANYTHING(acceleration_m_per_s2[1]);
    ANYTHING(*yaw_rate_rad_per_s);
}

/* ------------------------------------------------------------------------------------------ loader -- */

void laconic_loader_begin(laconic_loader *loader) { laconic_loader_take(loader, NULL); }

void laconic_loader_take(laconic_loader *loader, const uint8_t data[8]) {
    (void)data;
    Frama_C_make_unknown((char *)loader, sizeof *loader);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        loader->parameters.vehicle.wheel[i].locked = ANY_BOOL();
        loader->parameters.vehicle.wheel[i].undriven = ANY_BOOL();
    }
}

uint8_t laconic_loader_check(const laconic_loader *loader, uint16_t frame_count, uint32_t checksum, uint8_t *field,
                             uint8_t *item) {
    (void)loader;
    (void)frame_count;
    (void)checksum;
    *field = Frama_C_unsigned_char_interval(0, 255);
    *item = Frama_C_unsigned_char_interval(0, 255);
    return Frama_C_unsigned_char_interval(0, 255);
}

/* ------------------------------------------------------------------------------------------ frames -- */

/* From power-up: any frames, at any time. */
void prove_frames(void) {
    laconic_node_config config = {0};
    config.id_base = (uint16_t)ANY_WORD();
    config.can_fd = ANY_BOOL();
    config.method = laconic_method_by_number;
    config.nonce_seed = ANY_WORD();
    if (!laconic_node_init(&node, &config, ANY_WORD())) return;
    while (ANY_BOOL()) {
        any_frame();
        laconic_node_on_frame(&node, &frame, ANY_WORD());
        laconic_node_on_tick(&node, ANY_WORD());
        (void)laconic_node_next_frame(&node, &frame);
        (void)laconic_node_is_busy(&node);
        (void)laconic_node_idle_us(&node, ANY_WORD());
    }
}
