/* Raw frames: bytes of RAW_INPUT become numbers of the input, and outputs of the plant become bytes of RAW_OUTPUT. */
#include "laconic_node/raw_frames.h"

#include <string.h>

/* Numbers on the bus are little-endian; a big-endian target would have to reverse their bytes here. */
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "laconic: raw frames are written for little-endian targets"
#endif

void laconic_raw_restart(laconic_raw_input *raw) {
    raw->filled = 0;
    raw->position = 0;
    raw->segment = 0;
    raw->frames = 0;
    raw->complete = false;
    raw->broken = false;
}

/* Address of number k of one input; NULL beyond the last. */
static laconic_real *slot_in(laconic_input *input, uint8_t take, int32_t wheel_count, int32_t k) {
    if (take & LACONIC_RAW_VOLTAGE) {
        if (k < wheel_count) return &input->voltage_V[k];
        k -= wheel_count;
    }
    if (take & LACONIC_RAW_AXLE_TORQUE) {
        if (k < wheel_count) return &input->axle_torque_Nm[k];
        k -= wheel_count;
    }
    if (take & LACONIC_RAW_BODY_WRENCH) {
        if (k < 3) return k < 2 ? &input->body_force_N[k] : &input->body_moment_Nm;
        k -= 3;
    }
    if (take & LACONIC_RAW_WORLD_FORCE && k < 4)
        return k < 2 ? &input->world_force_N[k] : &input->world_force_point_m[k - 2];
    return NULL; /* GCOVR_EXCL_LINE: callers refuse numbers beyond the last */
}

static int32_t numbers_of(uint8_t take, int32_t wheel_count) {
    int32_t count = 0;
    if (take & LACONIC_RAW_VOLTAGE) count += wheel_count;
    if (take & LACONIC_RAW_AXLE_TORQUE) count += wheel_count;
    if (take & LACONIC_RAW_BODY_WRENCH) count += 3;
    if (take & LACONIC_RAW_WORLD_FORCE) count += 4;
    return count;
}

#if LACONIC_NODE_WITH_HINGES
static int32_t numbers_of_hinges(const laconic_raw_input *raw) {
    const uint8_t take = raw->hinge_count > 0 ? raw->take_hinges : 0U;
    int32_t count = (take & LACONIC_RAW_TWIST) != 0 ? 3 : 0;
    if (take & LACONIC_RAW_HINGE_VOLTAGE) count += raw->hinge_count;
    if (take & LACONIC_RAW_HINGE_TORQUE) count += raw->hinge_count;
    if (take & LACONIC_RAW_STEERING_RATE) count += raw->hinge_count;
    if (take & LACONIC_RAW_STEERING_ANGLE) count += raw->hinge_count;
    return count;
}

/* Address of number k of those of hinges. */
static laconic_real *slot_of_hinge(const laconic_raw_input *raw, int32_t sample, int32_t k) {
    laconic_articulated_input *input = &raw->hinged[sample];
    laconic_real *const all[] = {input->hinge_voltage_V, input->hinge_torque_Nm, input->hinge_rate_rad_per_s};
    for (uint32_t group = 0; group < 3U; group++) {
        if ((raw->take_hinges >> group & 1U) == 0) continue;
        if (k < raw->hinge_count) return &all[group][k];
        k -= raw->hinge_count;
    }
    if (raw->take_hinges & LACONIC_RAW_TWIST) {
        if (k < 3) return &input->twist[k];
        k -= 3; /* GCOVR_EXCL_LINE: SELECT lets no vehicle have twists and angles */
    }
    return &raw->angle_rad[k];
}

/* Numbers of one input, and how many inputs there are. */
static int32_t numbers_of_each(const laconic_raw_input *raw, int32_t wheel_count) {
    return numbers_of(raw->take, wheel_count) + numbers_of_hinges(raw);
}

/* Wheels that slip have held inputs: SELECT refuses samples of them. */
static int32_t samples_of(const laconic_raw_input *raw) { return raw->hinge_count > 0 ? 2 : 3; }

static laconic_real *slot_of(const laconic_raw_input *raw, laconic_input input[3], int32_t wheel_count, int32_t sample,
                             int32_t k) {
    const int32_t of_wheels = numbers_of(raw->take, wheel_count);
    if (k < of_wheels) return slot_in(&input[sample], raw->take, wheel_count, k);
    return slot_of_hinge(raw, sample, k - of_wheels);
}
#else
#define numbers_of_each(raw, wheel_count) numbers_of((raw)->take, wheel_count)
#define samples_of(raw) 3
#define slot_of(raw, input, wheel_count, sample, k) slot_in(&(input)[sample], (raw)->take, wheel_count, k)
#endif

static void store(laconic_raw_input *raw, laconic_input input[3], int32_t wheel_count) {
    const int32_t each = numbers_of_each(raw, wheel_count);
    const int32_t total = raw->take & LACONIC_RAW_SAMPLED ? samples_of(raw) * each : each;
    const int32_t sample = raw->position / each;
    laconic_real *to = slot_of(raw, input, wheel_count, sample, raw->position % each);
    memcpy(to, raw->number, sizeof raw->number);
    raw->position++;
    raw->filled = 0;
    raw->complete = raw->position == total;
}

bool laconic_raw_take(laconic_raw_input *raw, laconic_input input[3], int32_t wheel_count, uint8_t segment,
                      uint8_t segment_mask, const uint8_t *bytes, uint8_t count) {
    if (raw->broken && segment == 0) laconic_raw_restart(raw);
    const bool is_next = !raw->broken && !raw->complete && segment == raw->segment;
    if (!is_next || numbers_of_each(raw, wheel_count) == 0) {
        raw->broken = true;
        return false;
    }
    raw->segment = (uint8_t)((segment + 1U) & segment_mask);
    raw->frames++;
    for (uint8_t k = 0; k < count && !raw->complete; k++) {
        raw->number[raw->filled++] = bytes[k];
        if (raw->filled == sizeof raw->number) store(raw, input, wheel_count);
    }
    return true;
}

bool laconic_raw_is_whole(const laconic_raw_input *raw, uint16_t frames) {
    return !raw->broken && raw->frames == frames && (raw->complete || (raw->position == 0 && raw->filled == 0));
}

static laconic_real *collect_pose(laconic_real *to, const laconic_plant *plant) {
    laconic_pose pose;
    laconic_pose_of(&pose, &plant->model, &plant->state);
    *to++ = pose.x_m;
    *to++ = pose.y_m;
    *to++ = pose.heading_rad;
    return to;
}

static laconic_real *collect_sensors(laconic_real *to, uint8_t send, int32_t wheel_count,
                                     const laconic_sensor_outputs *sensed) {
    if (send & LACONIC_RAW_IMU) {
        for (int k = 0; k < 2; k++) *to++ = sensed->acceleration_body_m_per_s2[k];
        for (int k = 0; k < 2; k++) *to++ = sensed->imu_acceleration_m_per_s2[k];
        *to++ = sensed->imu_yaw_rate_rad_per_s;
    }
    for (int32_t i = 0; (send & LACONIC_RAW_ENCODER) && i < wheel_count; i++) *to++ = sensed->encoder_count[i];
    return to;
}

static laconic_real *copied(laconic_real *to, const laconic_real *numbers, int32_t count) {
    for (int32_t i = 0; i < count; i++) *to++ = numbers[i];
    return to;
}

/* The numbers before `to` are sent from now on. */
static void begin_output(laconic_raw_output *raw, const laconic_real *to) {
    raw->size = (uint16_t)((size_t)(to - raw->number) * sizeof(laconic_real));
    raw->position = 0;
    raw->segment = 0;
}

void laconic_raw_collect(laconic_raw_output *raw, const laconic_plant *plant, const laconic_input *held,
                         const laconic_sensor_outputs *sensed) {
    laconic_real *to = raw->number;
    const int32_t n = plant->model.wheel_count;
    if (!LACONIC_NODE_DRIVES_ONLY && raw->send & LACONIC_RAW_NU) {
        laconic_nu(&plant->model, &plant->state, to);
        to += 3;
    }
    if (raw->send & LACONIC_RAW_POSE) to = collect_pose(to, plant);
    if (raw->send & LACONIC_RAW_WHEEL_SPEED) {
        laconic_plant_wheel_speeds(plant, to);
        to += n;
    }
    if (raw->send & LACONIC_RAW_WHEEL_ANGLE) {
        laconic_plant_wheel_angles(plant, to);
        to += n;
    }
    if (!LACONIC_NODE_DRIVES_ONLY && raw->send & LACONIC_RAW_ENERGY) *to++ = laconic_plant_energy_J(plant);
    if (raw->send >= LACONIC_RAW_IMU) { /* one of the last three, which few choose */
        if (LACONIC_NODE_WITH_SENSORS) to = collect_sensors(to, raw->send, n, sensed);
        if (LACONIC_NODE_WITH_DRIVES && raw->send & LACONIC_RAW_HELD_TORQUE) to = copied(to, held->axle_torque_Nm, n);
    }
    begin_output(raw, to);
}

#if LACONIC_NODE_WITH_HINGES
/* Outputs that every vehicle has, in the order of all others. */
static laconic_real *collect_motion(laconic_real *to, uint8_t send, const laconic_articulated_motion *motion,
                                    int32_t wheel_count) {
    if (send & LACONIC_RAW_POSE) {
        *to++ = motion->x_m;
        *to++ = motion->y_m;
        *to++ = motion->heading_rad;
    }
    if (send & LACONIC_RAW_WHEEL_SPEED) to = copied(to, motion->wheel_speed_rad_per_s, wheel_count);
    if (send & LACONIC_RAW_WHEEL_ANGLE) to = copied(to, motion->wheel_angle_rad, wheel_count);
    if (send & LACONIC_RAW_ENERGY) *to++ = motion->energy_J;
    return to;
}

void laconic_raw_collect_hinges(laconic_raw_output *raw, const laconic_articulated_motion *motion, int32_t wheel_count,
                                int32_t body_count, const laconic_input *held) {
    laconic_real *to = collect_motion(raw->number, raw->send, motion, wheel_count);
    if (LACONIC_NODE_WITH_DRIVES && raw->send & LACONIC_RAW_HELD_TORQUE)
        to = copied(to, held->axle_torque_Nm, wheel_count);
    if (raw->send_hinges & LACONIC_RAW_VELOCITY) {
        to = copied(to, motion->velocity_m_per_s, 2);
        *to++ = motion->yaw_rate_rad_per_s;
    }
    if (raw->send_hinges & LACONIC_RAW_HINGE_ANGLE) to = copied(to, motion->hinge_angle_rad, body_count);
    if (raw->send_hinges & LACONIC_RAW_HINGE_RATE) to = copied(to, motion->hinge_rate_rad_per_s, body_count);
    begin_output(raw, to);
}
#endif

bool laconic_raw_give(laconic_raw_output *raw, uint8_t *bytes, uint8_t room) {
    const uint16_t rest_bytes = (uint16_t)(raw->size - raw->position);
    const uint8_t count = rest_bytes < room ? (uint8_t)rest_bytes : room;
    memcpy(bytes, (const uint8_t *)raw->number + raw->position, count);
    memset(bytes + count, 0, (size_t)(room - count));
    raw->position = (uint16_t)(raw->position + count);
    raw->segment++;
    return raw->position < raw->size;
}
