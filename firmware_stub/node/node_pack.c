/* Payloads of the frames that the node sends. A value out of range saturates and sets the frame's overrange flag:
 * the generated packers would wrap it. */
#include "node_internal.h"

#include "laconic_dbc.h"

#include <string.h>

static int32_t scaled(laconic_real value, int32_t per_unit, int32_t largest, uint8_t *overrange) {
    const laconic_real bound = (laconic_real)largest;
    const laconic_real half = (laconic_real)0.5;
    const laconic_real raw = value * (laconic_real)per_unit;
    if (raw >= -bound && raw <= bound) return (int32_t)(raw < 0 ? raw - half : raw + half);
    *overrange = 1;
    return raw > 0 ? largest : -largest;
}

#define SCALED(value, name, overrange) \
    scaled(value, LACONIC_WIRE_##name##_PER_UNIT, LACONIC_WIRE_##name##_LARGEST, overrange)

#if LACONIC_NODE_WITH_HINGES
/* What frames of every vehicle tell, of one with hinges. */
void laconic_node_pose_of(laconic_pose *pose, const laconic_node *node) {
    laconic_articulated_motion motion;
    if (!node->hinges.here) {
        laconic_pose_of(pose, &node->plant.model, &node->plant.state);
        return;
    }
    laconic_node_motion_of(&motion, node);
    pose->x_m = motion.x_m;
    pose->y_m = motion.y_m;
    pose->heading_rad = motion.heading_rad;
    pose->heading_wrapped_rad = laconic_angle_wrapped(motion.heading_rad);
}

void laconic_node_wheel_speeds(laconic_real speed_rad_per_s[], const laconic_node *node) {
    laconic_articulated_motion motion;
    if (!node->hinges.here) {
        laconic_plant_wheel_speeds(&node->plant, speed_rad_per_s);
        return;
    }
    laconic_node_motion_of(&motion, node);
    memcpy(speed_rad_per_s, motion.wheel_speed_rad_per_s,
           (size_t)node->hinges.model.wheel_count * sizeof *speed_rad_per_s);
}

void laconic_node_wheel_angles(laconic_real angle_rad[], const laconic_node *node) {
    laconic_articulated_motion motion;
    if (!node->hinges.here) {
        laconic_plant_wheel_angles(&node->plant, angle_rad);
        return;
    }
    laconic_node_motion_of(&motion, node);
    memcpy(angle_rad, motion.wheel_angle_rad, (size_t)node->hinges.model.wheel_count * sizeof *angle_rad);
}
#endif

static void pack_result(const laconic_node *node, uint8_t *data) {
    uint8_t offset = 0;
    while ((node->answers_due & BIT_OF(offset)) == 0) offset++;
    const laconic_node_result *result = &node->answer[offset];
    data[1] = (uint8_t)(result->request << 4);
    data[2] = result->command;
    data[3] = result->status;
    data[4] = result->field;
    data[5] = result->item;
    data[6] = node->state;
}

/* LACONIC_VERSION is the text "major.minor.patch"; the frame has six bits for each, the patch in the lowest. */
static uint32_t version(void) {
    uint32_t whole = 0;
    uint32_t part = 0;
    for (const char *text = LACONIC_VERSION; *text != 0; text++) {
        if (*text == '.') {
            whole = (whole | part) << 6;
            part = 0;
        } else {
            part = 10U * part + (uint32_t)(*text - '0');
        }
    }
    return whole | part;
}

#define METHOD_BITS 8 /* of IDENTITY.methods; a later method has none, and COMMIT refuses one that is not there */

static void pack_identity(const laconic_node *node, uint8_t *data) {
    data[1] = (uint8_t)(speaks_fd(node) << 4 | LACONIC_NODE_WITH_HINGES << 5 | LACONIC_NODE_WITH_SLIP << 6);
    data[2] = LACONIC_WIRE_VERSION;
    put16(data + 3, version());
    data[5] = sizeof(laconic_real);
    data[6] = LACONIC_MAX_WHEELS;
    for (int32_t k = 0; k < LACONIC_METHOD_COUNT && k < METHOD_BITS; k++)
        if (node->config.method(k) != NULL) data[7] = (uint8_t)(data[7] | 1U << k);
}

static void pack_challenge(const laconic_node *node, uint8_t *data) {
    data[1] = (uint8_t)(node->session.request << 4);
    put32(data + 2, node->session.nonce);
}

/* NU, POSE and WHEEL_SPEED have three numbers of 16 bits from byte 2 on, and the flag at bit 12. */
static void put_scaled(uint8_t *data, uint8_t index, laconic_real value, int32_t per_unit, int32_t largest) {
    uint8_t overrange = 0;
    put16(data + 2 + 2 * index, (uint32_t)scaled(value, per_unit, largest, &overrange));
    data[1] = (uint8_t)(data[1] | overrange << 4);
}

#define PUT(index, value, name) \
    put_scaled(data, index, value, LACONIC_WIRE_##name##_PER_UNIT, LACONIC_WIRE_##name##_LARGEST)

static void pack_nu(const laconic_node *node, uint8_t *data) {
    laconic_real nu[3];
    laconic_nu(&node->plant.model, &node->plant.state, nu);
    for (uint8_t k = 0; k < 3; k++) PUT(k, nu[k], NU_NU_1);
}

static void pack_pose(const laconic_node *node, uint8_t *data) {
    laconic_pose pose;
    laconic_node_pose_of(&pose, node);
    PUT(0, pose.x_m, POSE_X);
    PUT(1, pose.y_m, POSE_Y);
    PUT(2, pose.heading_wrapped_rad, POSE_HEADING);
}

static void pack_wheel_speed(const laconic_node *node, uint8_t *data) {
    laconic_real speed[LACONIC_MAX_WHEELS + 3] = {0};
    laconic_node_wheel_speeds(speed, node);
    data[1] = (uint8_t)(node->wheel_group << 5);
    for (uint8_t k = 0; k < 3; k++) PUT(k, speed[3 * node->wheel_group + k], WHEEL_SPEED_WHEEL_SPEED_1);
}

#if LACONIC_NODE_WITH_SENSORS
#if LACONIC_MAX_WHEELS > 16
#error "laconic: ENCODER numbers 16 wheels: set LACONIC_MAX_WHEELS to 16 or less, or LACONIC_NODE_WITH_SENSORS to 0"
#endif

static void pack_wheel_angle(const laconic_node *node, uint8_t *data) {
    laconic_real angle[LACONIC_MAX_WHEELS + 3] = {0};
    laconic_node_wheel_angles(angle, node);
    for (uint8_t k = 0; k < 3; k++)
        PUT(k, laconic_angle_wrapped(angle[3 * node->angle_group + k]), WHEEL_ANGLE_WHEEL_ANGLE_1);
    data[1] = (uint8_t)(node->angle_group << 5);
}

static void pack_imu(const laconic_node *node, uint8_t *data) {
    laconic_real acceleration[2];
    laconic_real yaw_rate;
    laconic_imu_read(&node->sensors, node->plant.integrator.step_s, acceleration, &yaw_rate);
    PUT(0, acceleration[0], IMU_ACCELERATION_X);
    PUT(1, acceleration[1], IMU_ACCELERATION_Y);
    PUT(2, yaw_rate, IMU_YAW_RATE);
}

static void pack_encoder(const laconic_node *node, uint8_t *data) {
    const laconic_sensor_settings *settings = &node->sensors.settings;
    const laconic_encoder *encoder = &node->sensors.encoder[node->encoder_wheel];
    const int32_t counts = settings->encoder[node->encoder_wheel].counts_per_turn;
    data[1] = (uint8_t)(node->encoder_wheel << 4);
    put32(data + 2, (uint32_t)laconic_encoder_shown(encoder, settings->encoder_wrap));
    put16(data + 6, (uint32_t)laconic_encoder_turns(encoder, counts));
}
#endif

#if LACONIC_NODE_WITH_HINGES
static void pack_velocity(const laconic_node *node, uint8_t *data) {
    laconic_articulated_motion motion;
    laconic_node_motion_of(&motion, node);
    PUT(0, motion.velocity_m_per_s[0], VELOCITY_AHEAD);
    PUT(1, motion.velocity_m_per_s[1], VELOCITY_LEFT);
    PUT(2, motion.yaw_rate_rad_per_s, VELOCITY_YAW_RATE);
}

static void pack_hinge_angle(const laconic_node *node, uint8_t *data) {
    const int32_t first = 3 * (int32_t)node->hinges.angle_group;
    laconic_articulated_motion motion;
    laconic_node_motion_of(&motion, node);
    for (uint8_t k = 0; k < 3 && first + k < node->hinges.model.body_count; k++)
        PUT(k, laconic_angle_wrapped(motion.hinge_angle_rad[first + k]), HINGE_ANGLE_HINGE_ANGLE_1);
    data[1] = (uint8_t)(node->hinges.angle_group << 5);
}

static void pack_hinge_rate(const laconic_node *node, uint8_t *data) {
    const int32_t first = 3 * (int32_t)node->hinges.rate_group;
    laconic_articulated_motion motion;
    laconic_node_motion_of(&motion, node);
    data[1] = (uint8_t)(node->hinges.rate_group << 5);
    for (uint8_t k = 0; k < 3 && first + k < node->hinges.model.body_count; k++)
        PUT(k, motion.hinge_rate_rad_per_s[first + k], HINGE_RATE_HINGE_RATE_1);
}
#endif

#if LACONIC_NODE_WITH_ESTIMATE
/* Page k: number k of those now, then of the largest. A number beyond the range of single precision is sent as
 * infinity. */
static void pack_error_estimate(const laconic_node *node, uint8_t *data) {
    const laconic_error *sizes = node->estimate_page < 4 ? &node->estimated.now : &node->estimated.largest;
    const laconic_real size[4] = {sizes->nu_rad_per_s, sizes->place_m, sizes->heading_rad, sizes->wheel_angle_rad};
    const float single = (float)size[node->estimate_page & 3U];
    const uint64_t unknown = node->estimated.unknown;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    data[1] = (uint8_t)(node->estimate_page << 4);
    put32(data + 2, bits);
    put16(data + 6, unknown > UINT16_MAX ? UINT16_MAX : (uint32_t)unknown);
}
#endif

#define MOST_LATENESS 32767U

/* While drives play there is no rig to be deaf to; the bit then tells that a drive has heard no controller in time. It
 * stays after STOP, since play reads its figures when the vehicle is at rest and no watchdog runs any more. A count
 * that integrity.c has found to be changed stays in the node until drives start again. */
static bool is_deaf(const laconic_node *node) {
#if LACONIC_NODE_WITH_DRIVES
    const bool tells_of_drives = plays_drives(node) || !is_running(node);
    for (int32_t k = 0; tells_of_drives && k < node->drives.count && k < LACONIC_DRIVE_AXES; k++)
        if (node->drives.drive[k].unheard) return true;
#endif
    return node->session.deaf != 0;
}

static void pack_heartbeat(const laconic_node *node, uint8_t *data) {
    const uint32_t late = node->free_run.worst_lateness_us;
    const uint32_t deaf = is_deaf(node) ? 0x8000U : 0U;
    data[1] = (uint8_t)(node->state << 4);
    put32(data + 2, (uint32_t)node->plant.steps);
    put16(data + 6, (late > MOST_LATENESS ? MOST_LATENESS : late) | deaf);
}

/* The counters have the order of the pages, three to a page, and the target is little-endian (raw_frames.c). */
static void pack_counters(const laconic_node *node, uint8_t *data) {
    data[1] = (uint8_t)(node->counter_page << 4);
    memcpy(data + 2, (const uint8_t *)&node->counters + 6 * node->counter_page, 6);
}

/* Packed by hand: the generated packer for these numbers would have 300 lines. */
static void pack_state_fd(const laconic_node *node, uint8_t *data) {
    laconic_real nu[3];
    laconic_real speed[LACONIC_MAX_WHEELS];
    laconic_pose pose;
    uint8_t over = 0;
    memset(data, 0, 64);
    laconic_nu(&node->plant.model, &node->plant.state, nu);
    laconic_pose_of(&pose, &node->plant.model, &node->plant.state);
    laconic_plant_wheel_speeds(&node->plant, speed);
    put32(data + 4, (uint32_t)node->plant.steps);
    for (int k = 0; k < 3; k++) put32(data + 8 + 4 * k, (uint32_t)SCALED(nu[k], STATE_FD_NU_1, &over));
    put32(data + 20, (uint32_t)SCALED(pose.x_m, STATE_FD_X, &over));
    put32(data + 24, (uint32_t)SCALED(pose.y_m, STATE_FD_Y, &over));
    put32(data + 28, (uint32_t)SCALED(pose.heading_wrapped_rad, STATE_FD_HEADING, &over));
    for (int32_t i = 0; i < node->plant.model.wheel_count && i < 16; i++)
        put16(data + 32 + 2 * i, (uint32_t)SCALED(speed[i], STATE_FD_WHEEL_SPEED_1, &over));
    data[3] = over;
}

static void pack_raw(laconic_node *node, uint8_t *data) {
    data[1] = (uint8_t)(node->raw_output.segment << 4);
    laconic_raw_give(&node->raw_output, data + 2, 6);
}

static void pack_raw_fd(laconic_node *node, uint8_t *data) {
    data[3] = node->raw_output.segment;
    laconic_raw_give(&node->raw_output, data + 4, 60);
}

void laconic_node_pack(laconic_node *node, uint8_t offset, uint8_t *data) {
    memset(data, 0, 8);
    switch (offset) {
    case LACONIC_WIRE_RESULT: pack_result(node, data); break;
    case LACONIC_WIRE_IDENTITY: pack_identity(node, data); break;
    case LACONIC_WIRE_CHALLENGE: pack_challenge(node, data); break;
    case LACONIC_WIRE_NU: pack_nu(node, data); break;
    case LACONIC_WIRE_POSE: pack_pose(node, data); break;
    case LACONIC_WIRE_WHEEL_SPEED: pack_wheel_speed(node, data); break;
    case LACONIC_WIRE_RAW_OUTPUT: pack_raw(node, data); break;
    case LACONIC_WIRE_HEARTBEAT: pack_heartbeat(node, data); break;
    case LACONIC_WIRE_COUNTERS: pack_counters(node, data); break;
#if LACONIC_NODE_WITH_SENSORS
    case LACONIC_WIRE_WHEEL_ANGLE: pack_wheel_angle(node, data); break;
    case LACONIC_WIRE_IMU: pack_imu(node, data); break;
    case LACONIC_WIRE_ENCODER: pack_encoder(node, data); break;
#endif
#if LACONIC_NODE_WITH_HINGES
    case LACONIC_WIRE_VELOCITY: pack_velocity(node, data); break;
    case LACONIC_WIRE_HINGE_ANGLE: pack_hinge_angle(node, data); break;
    case LACONIC_WIRE_HINGE_RATE: pack_hinge_rate(node, data); break;
#endif
#if LACONIC_NODE_WITH_ESTIMATE
    case LACONIC_WIRE_ERROR_ESTIMATE: pack_error_estimate(node, data); break;
#endif
    default:
        if (!LACONIC_NODE_CAN_FD) break;
        if (offset == LACONIC_WIRE_STATE_FD) pack_state_fd(node, data);
        if (offset == LACONIC_WIRE_RAW_OUTPUT_FD) pack_raw_fd(node, data);
        break;
    }
}
