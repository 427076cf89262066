/* The sensors of one vehicle beside its plant: their settings, and what they see of each step. */
#include "imu.h"

/* ------------------------------------------------------------------------------------- settings -- */

typedef struct checked_setting {
    uint16_t offset; /* in the struct that the table is for */
    uint8_t field, kind, rule, items;
} checked_setting;

#define ROW(type, number, member, KIND, RULE, items) \
    {offsetof(type, member), number, LACONIC_KIND_##KIND, LACONIC_RULE_##RULE, items},
#define OF_IMU(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    ROW(laconic_imu_settings, number, member, KIND, RULE, 1)
#define OF_IMU_ARRAY(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    ROW(laconic_imu_settings, number, member, KIND, RULE, 2)
#define OF_WHEEL(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    ROW(laconic_encoder_settings, number, member, KIND, RULE, 1)

static const checked_setting of_imu[] = {LACONIC_IMU_FIELDS(OF_IMU, ) LACONIC_IMU_ARRAY_FIELDS(OF_IMU_ARRAY, )};
static const checked_setting of_encoder[] = {LACONIC_WHEEL_ENCODER_FIELDS(OF_WHEEL, )};

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* Of settings and samples, far beyond what any instrument shows: so that products of two stay in the range. */
#define LARGEST_NUMBER R(1e15)

static real limit_of(uint8_t rule) { return rule == LACONIC_RULE_ANGLE ? LARGEST_ANGLE : LARGEST_NUMBER; }

static laconic_status status_of(real value, uint8_t rule) {
    if (!is_finite(value)) return LACONIC_NOT_FINITE;
    if (rule == LACONIC_RULE_NOT_NEGATIVE && value < R(0)) return LACONIC_NEGATIVE;
    return magnitude(value) > limit_of(rule) ? LACONIC_OVERFLOW : LACONIC_OK;
}

static real value_of(const void *of, const checked_setting *number, int32_t item) {
    const unsigned char *at = (const unsigned char *)of + number->offset;
    if (number->kind == LACONIC_KIND_INTEGER) return (real)((const int32_t *)(const void *)at)[item];
    return ((const real *)(const void *)at)[item];
}

/* `item`: that of the struct; 0: the numbers of arrays are the items. */
static laconic_status check_settings(const void *of, const checked_setting *numbers, size_t count, int32_t item,
                                     laconic_refusal *why) {
    for (size_t k = 0; k < count; k++) {
        for (int32_t i = 0; i < numbers[k].items; i++) {
            const real value = value_of(of, &numbers[k], i);
            const laconic_status status = status_of(value, numbers[k].rule);
            const int32_t named = numbers[k].items > 1 ? i + 1 : item;
            if (status != LACONIC_OK)
                return refuse(why, status, (laconic_field)numbers[k].field, named, value,
                              status == LACONIC_OVERFLOW ? limit_of(numbers[k].rule) : R(0));
        }
    }
    return LACONIC_OK;
}

static laconic_status above(laconic_refusal *why, laconic_sensor_field field, int32_t item, int32_t value,
                            int32_t limit) {
    return refuse(why, LACONIC_ABOVE_LIMIT, (laconic_field)field, item, (real)value, (real)limit);
}

static laconic_status check_encoders(const laconic_sensor_settings *settings, int32_t wheel_count,
                                     laconic_refusal *why) {
    const int32_t wrap = settings->encoder_wrap;
    if (wrap < 0)
        return refuse(why, LACONIC_NEGATIVE, (laconic_field)LACONIC_SENSOR_FIELD_WHEEL_ENCODER_WRAP, 0, (real)wrap,
                      R(0));
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        const laconic_encoder_settings *encoder = &settings->encoder[i];
        const laconic_status status = check_settings(encoder, of_encoder, COUNT(of_encoder), i + 1, why);
        if (status != LACONIC_OK) return status;
        if (encoder->counts_per_turn > 0 && (i >= wheel_count || !LACONIC_WITH_WHEEL_ANGLES))
            return above(why, LACONIC_SENSOR_FIELD_WHEEL_ENCODER_COUNTS, i + 1, encoder->counts_per_turn, 0);
    }
    return LACONIC_OK;
}

laconic_status laconic_sensor_settings_check(const laconic_sensor_settings *settings, int32_t wheel_count,
                                             laconic_refusal *why) {
    const laconic_status status = check_settings(&settings->imu, of_imu, COUNT(of_imu), 0, why);
    if (status != LACONIC_OK) return status;
    if (settings->imu.delay_steps > LACONIC_IMU_MAX_DELAY)
        return above(why, LACONIC_SENSOR_FIELD_IMU_DELAY, 0, settings->imu.delay_steps, LACONIC_IMU_MAX_DELAY);
    return check_encoders(settings, wheel_count, why);
}

/* ------------------------------------------------------------------------------ before and after -- */

void laconic_sensors_before(laconic_sensor_moment *before, const laconic_plant *plant) {
    laconic_odometer_of(&before->odometer, plant);
    before->yaw_rate_rad_per_s = laconic_body_velocity(&plant->model, &plant->state, before->velocity_m_per_s);
}

static laconic_status turn_encoders(laconic_sensors *sensors, const laconic_plant *plant,
                                    const laconic_sensor_moment *before, laconic_refusal *why) {
    for (int32_t i = 0; i < plant->model.wheel_count; i++) {
        const laconic_encoder_settings *settings = &sensors->settings.encoder[i];
        if (settings->counts_per_turn == 0) continue;
        const real turned_rad = laconic_wheel_turned_rad(plant, &before->odometer, i);
        if (!laconic_encoder_turn(&sensors->encoder[i], settings, turned_rad))
            return refuse(why, LACONIC_OVERFLOW, (laconic_field)LACONIC_SENSOR_FIELD_WHEEL_ENCODER_COUNTS, i + 1,
                          turned_rad, R(0));
    }
    return LACONIC_OK;
}

/* ------------------------------------------------------------------------------------- samples -- */

#define SAMPLES (LACONIC_IMU_MAX_DELAY + 1)

static laconic_imu_sample *sample_of(laconic_sensors *sensors, uint64_t number) {
    return &sensors->sample[number % SAMPLES];
}

static laconic_status enter_sample(laconic_sensors *sensors, const laconic_plant *plant, const laconic_input *held,
                                   const laconic_sensor_moment *before, laconic_refusal *why) {
    const laconic_imu_settings *imu = &sensors->settings.imu;
    laconic_imu_sample *sample = sample_of(sensors, plant->steps);
    sensors->newest = plant->steps;
    if (has_friction(plant)) {
        laconic_imu_feel_step(sample, imu, plant, before);
        laconic_accelerate_over_step(sensors->acceleration_m_per_s2, plant, before);
    } else {
        laconic_imu_feel_now(sample, imu, plant, held);
    }
    const real *force = sample->specific_force_m_per_s2;
    if (magnitude(force[0]) <= LARGEST_NUMBER && magnitude(force[1]) <= LARGEST_NUMBER) return LACONIC_OK;
    const real along = magnitude(force[0]), across = magnitude(force[1]);
    const laconic_sensor_field farther =
        magnitude(imu->y_m) > magnitude(imu->x_m) ? LACONIC_SENSOR_FIELD_IMU_Y : LACONIC_SENSOR_FIELD_IMU_X;
    return refuse(why, LACONIC_OVERFLOW, (laconic_field)farther, 0, along <= across ? force[1] : force[0], R(0));
}

laconic_status laconic_sensors_after(laconic_sensors *sensors, const laconic_plant *plant, const laconic_input *held,
                                     const laconic_sensor_moment *before, laconic_refusal *why) {
    const laconic_status status = turn_encoders(sensors, plant, before, why);
    return status == LACONIC_OK ? enter_sample(sensors, plant, held, before, why) : status;
}

laconic_status laconic_sensors_start(laconic_sensors *sensors, const laconic_sensor_settings *settings,
                                     const laconic_plant *plant, laconic_refusal *why) {
    const laconic_input without = ALL_ZERO;
    laconic_sensor_moment now;
    const laconic_status status = laconic_sensor_settings_check(settings, plant->model.wheel_count, why);
    if (status != LACONIC_OK) return status;
    const laconic_sensor_settings kept = *settings; /* which may be the sensors' own */
    sensors->settings = kept;
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        sensors->encoder[i].count = 0;
        sensors->encoder[i].rest = R(0);
    }
    for (int k = 0; k < 2; k++) sensors->acceleration_m_per_s2[k] = R(0);
    laconic_sensors_before(&now, plant);
    (void)enter_sample(sensors, plant, &without, &now, NULL); /* a sample out of range is refused by the first step */
    const laconic_imu_sample first = *sample_of(sensors, plant->steps);
    for (int32_t k = 0; k < SAMPLES; k++) sensors->sample[k] = first;
    return LACONIC_OK;
}

/* --------------------------------------------------------------------------------------- steps -- */

/* Whether a sensor must see every step; else the last one tells all. */
static bool watches_each_step(const laconic_sensors *sensors, const laconic_plant *plant) {
    bool watches = has_friction(plant) || sensors->settings.imu.delay_steps > 0;
    for (int32_t i = 0; i < plant->model.wheel_count; i++)
        watches = watches || sensors->settings.encoder[i].counts_per_turn > 0;
    return watches;
}

static laconic_status run_unwatched(laconic_sensors *sensors, laconic_plant *plant, const laconic_input *held,
                                    uint64_t steps, laconic_refusal *why) {
    const uint64_t before = plant->steps;
    laconic_status status = laconic_plant_run(plant, held, steps, why);
    if (plant->steps == before) return status;
    const laconic_status seen = enter_sample(sensors, plant, held, NULL, status == LACONIC_OK ? why : NULL);
    return status == LACONIC_OK ? seen : status;
}

laconic_status laconic_sensors_run(laconic_sensors *sensors, laconic_plant *plant, const laconic_input *held,
                                   uint64_t steps, laconic_refusal *why) {
    laconic_sensor_moment before;
    laconic_status status = LACONIC_OK;
    if (!watches_each_step(sensors, plant)) return run_unwatched(sensors, plant, held, steps, why);
    for (uint64_t k = 0; k < steps && status == LACONIC_OK; k++) {
        laconic_sensors_before(&before, plant);
        status = laconic_plant_run(plant, held, 1, why);
        if (status == LACONIC_OK) status = laconic_sensors_after(sensors, plant, held, &before, why);
    }
    return status;
}

laconic_status laconic_sensors_run_sampled(laconic_sensors *sensors, laconic_plant *plant,
                                           const laconic_input samples[3], laconic_refusal *why) {
    laconic_sensor_moment before;
    laconic_sensors_before(&before, plant);
    const laconic_status status = laconic_plant_run_sampled(plant, samples, why);
    return status == LACONIC_OK ? laconic_sensors_after(sensors, plant, &samples[2], &before, why) : status;
}

/* -------------------------------------------------------------------------------------- reading -- */

void laconic_acceleration_body(laconic_real acceleration_m_per_s2[2], const laconic_sensors *sensors,
                               const laconic_plant *plant, const laconic_input *input) {
    if (!has_friction(plant)) {
        laconic_accelerate_now(acceleration_m_per_s2, plant, input);
        return;
    }
    for (int k = 0; k < 2; k++) acceleration_m_per_s2[k] = sensors->acceleration_m_per_s2[k];
}

void laconic_imu_read(const laconic_sensors *sensors, laconic_real step_s, laconic_real acceleration_m_per_s2[2],
                      laconic_real *yaw_rate_rad_per_s) {
    const laconic_imu_settings *imu = &sensors->settings.imu;
    const uint64_t back = (uint64_t)imu->delay_steps;
    const laconic_imu_sample *sample = &sensors->sample[(sensors->newest % SAMPLES + SAMPLES - back) % SAMPLES];
    laconic_imu_show(imu, sample, sensors->newest - back, step_s, acceleration_m_per_s2, yaw_rate_rad_per_s);
}

void laconic_sensors_read(laconic_sensor_outputs *outputs, const laconic_sensors *sensors, const laconic_plant *plant,
                          const laconic_input *input) {
    laconic_acceleration_body(outputs->acceleration_body_m_per_s2, sensors, plant, input);
    laconic_imu_read(sensors, plant->integrator.step_s, outputs->imu_acceleration_m_per_s2,
                     &outputs->imu_yaw_rate_rad_per_s);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++)
        outputs->encoder_count[i] = (real)laconic_encoder_shown(&sensors->encoder[i], sensors->settings.encoder_wrap);
}
