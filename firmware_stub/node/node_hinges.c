/* Vehicles with hinges: COMMIT, RESET and SELECT for them, their commands, steps and outputs. */
#include "node_internal.h"

#if LACONIC_NODE_WITH_HINGES

#include <string.h>

/* ------------------------------------------------------------------------------------ vehicle -- */

/* What does not act on a vehicle with hinges. 0 iff nothing of it was sent. */
static uint8_t not_of_hinges(const laconic_parameters *new) {
#if LACONIC_NODE_WITH_SENSORS
    if (laconic_node_sensors_are_set(&new->sensors)) return LACONIC_SENSOR_FIELD_IMU_X;
#endif
    for (int k = 0; k < 3; k++)
        if (new->start.nu_rad_per_s[k] != 0) return LACONIC_FIELD_START_NU;
    return 0;
}

static void join(laconic_articulated_vehicle *whole, const laconic_parameters *new) {
    const laconic_node_bodies *bodies = &new->bodies;
    whole->base = new->vehicle;
    whole->body_count = bodies->body_count;
    memcpy(whole->wheel_body, bodies->wheel_body, sizeof whole->wheel_body);
    memcpy(whole->body, bodies->body, sizeof whole->body);
}

#if LACONIC_NODE_WITH_SLIP

static laconic_status prepare_tree(laconic_node_hinges *fresh, const laconic_parameters *new, laconic_refusal *why) {
    laconic_tree_vehicle vehicle;
    memset(&vehicle, 0, sizeof vehicle);
    join(&vehicle.hinged, new);
    memcpy(vehicle.hinge, new->bodies.tree_hinge, sizeof vehicle.hinge);
    memcpy(vehicle.wheel, new->bodies.tree_wheel, sizeof vehicle.wheel);
    return laconic_tree_prepare(&fresh->tree_model, &vehicle, why);
}

static laconic_status refuse_run(laconic_refusal *why, laconic_status status, laconic_field field) {
    why->status = status;
    why->field = field;
    return status;
}

/* Whether something leads a hinge: a command its rate, or a servo or loop its angle. */
static laconic_hinge_motion motion_of_hinge(const laconic_tree_body *body) {
    const bool led = body->servo || body->loop_V_per_rad != 0 || body->loop_Vs_per_rad != 0;
    if (body->hinge == LACONIC_HINGE_PRESCRIBED) return LACONIC_MOTION_PRESCRIBED;
    return led ? LACONIC_MOTION_FOLLOWING : LACONIC_MOTION_OWN;
}

/* What frames and drives of every vehicle with hinges read of its model. */
static void describe_tree(laconic_node_hinges *fresh, laconic_real step_s) {
    const laconic_tree_model *m = &fresh->tree_model;
    fresh->slips = true;
    fresh->integrator.step_s = step_s;
    fresh->model.wheel_count = m->wheel_count;
    fresh->model.body_count = m->body_count;
    for (int32_t b = 0; b < m->body_count; b++) fresh->model.link[b].motion = motion_of_hinge(&m->body[b + 1]);
}

/* One step of auto; a whole number of it is checked by each step. */
static laconic_status find_tree(laconic_node_hinges *fresh, const laconic_parameters *new, laconic_refusal *why) {
    if (new->method != LACONIC_ARTICULATED_AUTO)
        return refuse_run(why, LACONIC_METHOD_WITHOUT_FRICTION, LACONIC_FIELD_METHOD);
    if (!(new->step_s > 0)) return refuse_run(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP);
    const laconic_status status = prepare_tree(fresh, new, why);
    if (status == LACONIC_OK) describe_tree(fresh, new->step_s);
    return status;
}

/* As the scene has it: speeds of all 0 are none. */
static laconic_status set_tree_start(laconic_node_hinges *hinges, const laconic_real *wheel_speed_rad_per_s,
                                     laconic_refusal *why) {
    laconic_tree_start start;
    memset(&start, 0, sizeof start);
    start.hinged = hinges->start;
    memcpy(start.wheel_speed_rad_per_s, wheel_speed_rad_per_s, sizeof start.wheel_speed_rad_per_s);
    return laconic_tree_state_set(&hinges->tree, &hinges->tree_model, &start, why);
}

static bool is_to_slip(const laconic_parameters *new) { return new->vehicle.ground.friction_coefficient != 0; }
#endif

static laconic_status prepare(laconic_node_hinges *fresh, const laconic_parameters *new, laconic_refusal *why) {
    laconic_articulated_vehicle whole;
#if LACONIC_NODE_WITH_SLIP
    if (is_to_slip(new)) return find_tree(fresh, new, why);
#endif
    memset(&whole, 0, sizeof whole);
    join(&whole, new);
    const laconic_status status = laconic_articulated_prepare(&fresh->model, &whole, why);
    if (status != LACONIC_OK) return status;
    return laconic_articulated_integrator_prepare(&fresh->integrator, new->method, &fresh->model, new->step_s, why);
}

static laconic_status set_start(laconic_node_hinges *hinges, const laconic_start *start, laconic_refusal *why) {
#if LACONIC_NODE_WITH_SLIP
    if (hinges->slips) return set_tree_start(hinges, start->wheel_speed_rad_per_s, why);
#endif
    (void)start;
    return laconic_articulated_state_set(&hinges->state, NULL, &hinges->model, &hinges->start, &hinges->first, why);
}

/* The loaded vehicle, its step and its start. */
static laconic_status find(laconic_node_hinges *fresh, const laconic_parameters *new, laconic_refusal *why) {
    const laconic_status status = prepare(fresh, new, why);
    if (status != LACONIC_OK) return status;
    fresh->here = true;
    fresh->start = new->bodies.start;
    fresh->start.x_m = new->start.x_m;
    fresh->start.y_m = new->start.y_m;
    fresh->start.heading_rad = new->start.heading_rad;
    memcpy(fresh->first.hinge_rate_rad_per_s, new->bodies.hinge_rate_rad_per_s,
           sizeof new->bodies.hinge_rate_rad_per_s);
    memcpy(fresh->first.twist, new->bodies.twist, sizeof new->bodies.twist);
    return set_start(fresh, &new->start, why);
}

#if LACONIC_NODE_WITH_DRIVES
/* A drive turns a wheel, or a hinge that nothing else moves: neither its own wheels nor a twist, servo or loop. */
static uint8_t check_drives(const laconic_node *node, const laconic_node_hinges *fresh, uint8_t *field, uint8_t *item) {
    const laconic_drive_plan *plan = &node->loader.parameters.drives;
    const laconic_articulated_model *m = &fresh->model;
    const uint8_t status = laconic_node_check_drives(node, plan, m->wheel_count + m->body_count, field, item);
    if (status != 0) return status;
    for (int32_t b = 0; b < m->body_count; b++) {
        const laconic_hinge_motion motion = m->link[b].motion;
        const bool is_own = motion == LACONIC_MOTION_OWN || motion == LACONIC_MOTION_PRESCRIBED;
        if (plan->protocol == 0 || is_own || plan->drive[m->wheel_count + b].node_id < 0) continue;
        *field = LACONIC_DRIVES_FIELD_DRIVE_NODE_ID;
        *item = (uint8_t)(m->wheel_count + b + 1);
        return LACONIC_WIRE_STATUS_NOT_SUPPORTED;
    }
    return 0;
}
#endif

/* The numbers that frames of every vehicle read from the plant, and nothing else of it. */
static void count_in_plant(laconic_node *node) {
    memset(&node->plant, 0, sizeof node->plant);
    node->plant.model.wheel_count = node->hinges.model.wheel_count;
    node->plant.integrator.step_s = node->hinges.integrator.step_s;
}

/* Frames that SELECT chose for the vehicle before stay chosen where this one has them. */
static void adopt(laconic_node *node, const laconic_node_hinges *fresh) {
    const uint8_t send = node->hinges.send;
    node->hinges = *fresh;
    node->hinges.send = send;
    node->send &= (uint8_t)~SENDS_NOT_OF_HINGES;
    node->raw_output.send &= (uint8_t)~RAW_NOT_OF_HINGES;
#if LACONIC_NODE_WITH_SLIP
    if (fresh->slips) node->raw_input.take &= (uint8_t)~LACONIC_RAW_SAMPLED;
    node->raw_input.take_hinges &= (uint8_t)~(fresh->slips ? LACONIC_RAW_TWIST : LACONIC_RAW_STEERING_ANGLE);
#endif
    node->raw_input.hinge_count = fresh->model.body_count;
#if LACONIC_NODE_WITH_SENSORS
    memset(&node->sensors, 0, sizeof node->sensors);
    node->has_sensors = false;
#endif
    node->pending &= ~PENDING_NOT_OF_HINGES;
    count_in_plant(node);
#if LACONIC_NODE_WITH_ESTIMATE
    node->estimates = false;
#endif
}

uint8_t laconic_node_adopt_hinges(laconic_node *node, uint8_t *field, uint8_t *item) {
    const laconic_parameters *new = &node->loader.parameters;
    laconic_node_hinges fresh;
    laconic_refusal why = {0};
    *field = not_of_hinges(new);
    if (*field != 0) return LACONIC_WIRE_STATUS_NOT_SUPPORTED;
    memset(&fresh, 0, sizeof fresh);
    const laconic_status status = find(&fresh, new, &why);
    *field = (uint8_t)why.field;
    *item = (uint8_t)why.item;
    if (status != LACONIC_OK) return (uint8_t)status;
#if LACONIC_NODE_WITH_DRIVES
    const uint8_t refused = check_drives(node, &fresh, field, item);
    if (refused != 0) return refused;
#endif
    adopt(node, &fresh);
    return 0;
}

void laconic_node_deselect_hinges(laconic_node *node) {
    node->hinges.send = 0;
    node->raw_output.send_hinges = 0;
    node->raw_input.take_hinges = 0;
}

void laconic_node_drop_hinges(laconic_node *node) {
    node->hinges.here = false;
    laconic_node_deselect_hinges(node);
    node->raw_input.hinge_count = 0;
    node->pending &= ~PENDING_OF_HINGES;
}

laconic_status laconic_node_restart_hinges(laconic_node *node, laconic_refusal *why) {
    const laconic_status status = set_start(&node->hinges, &node->start, why);
    if (status == LACONIC_OK) node->plant.steps = 0;
    return status;
}

/* ------------------------------------------------------------------------------------- SELECT -- */

#define UNUSED_SENDS 0xC0U
#define UNUSED_TAKES 0xE0U

bool laconic_node_may_select_hinges(const laconic_node *node, const uint8_t *data) {
    if (((data[5] & UNUSED_SENDS) | (data[6] & UNUSED_TAKES) | data[7]) != 0) return false;
    if (!node->hinges.here) return (data[5] | data[6]) == 0;
    const uint32_t raw = data[3] & 0x7FU & RAW_NOT_OF_HINGES;
    const bool is_held = (data[4] & LACONIC_RAW_SAMPLED) == 0, angles = (data[6] & LACONIC_RAW_STEERING_ANGLE) != 0;
    if (slips(node) ? !is_held || (data[6] & LACONIC_RAW_TWIST) != 0 : angles) return false;
    return (data[2] & SENDS_NOT_OF_HINGES) == 0 && raw == 0 && (data[4] & SELECTS_ESTIMATE) == 0;
}

void laconic_node_select_hinges(laconic_node *node, const uint8_t *data) {
    node->hinges.send = data[5] & 7U;
    node->raw_output.send_hinges = data[5] >> 3 & 7U;
    node->raw_input.take_hinges = data[6] & LACONIC_RAW_HINGE_TAKES;
}

void laconic_node_publish_hinges(laconic_node *node) {
    node->hinges.angle_group = 0;
    node->hinges.rate_group = 0;
    if (node->hinges.send & LACONIC_NODE_SEND_VELOCITY) node->pending |= BIT_OF(LACONIC_WIRE_VELOCITY);
    if (node->hinges.send & LACONIC_NODE_SEND_HINGE_ANGLE) node->pending |= BIT_OF(LACONIC_WIRE_HINGE_ANGLE);
    if (node->hinges.send & LACONIC_NODE_SEND_HINGE_RATE) node->pending |= BIT_OF(LACONIC_WIRE_HINGE_RATE);
}

/* ------------------------------------------------------------------------------------ commands -- */

/* Rates and twist do not change. */
static void hold(laconic_articulated_input *input) {
    memset(input->hinge_acceleration_rad_per_s2, 0, sizeof input->hinge_acceleration_rad_per_s2);
    memset(input->twist_rate, 0, sizeof input->twist_rate);
}

/* Forces and rates become 0, or before the first step those of the start; steered wheels and the angles of servos keep
 * their direction. */
void laconic_node_clear_hinge_inputs(laconic_node *node) {
    laconic_node_hinges *hinges = &node->hinges;
    const bool at_start = node->plant.steps == 0;
    memset(hinges->input, 0, sizeof hinges->input);
    for (int k = 0; k < 2; k++) {
        if (at_start) hinges->input[k] = hinges->first;
        memcpy(hinges->input[k].twist, at_start ? hinges->first.twist : hinges->twist, sizeof hinges->twist);
    }
#if LACONIC_NODE_WITH_SLIP
    if (at_start) memcpy(hinges->angle_rad, hinges->start.hinge_angle_rad, sizeof hinges->angle_rad);
#endif
    hinges->changes = false;
}

/* The least part of a twist that wheels of the carriage refuse is that of rounding to a frame's numbers; what is more
 * stays, and the core refuses it. */
#define ROUNDING_OF_TWIST ((laconic_real)1e-3)

static laconic_real dot(laconic_vector a, laconic_vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* Takes from a twist of S_0 what one row allows no motion to have. */
static void roll_along(laconic_vector *twist, const laconic_vector *row) {
    const laconic_real along = dot(*row, *twist), square = dot(*row, *row);
    if (along * along > ROUNDING_OF_TWIST * ROUNDING_OF_TWIST * square * dot(*twist, *twist)) return;
    twist->x -= along / square * row->x;
    twist->y -= along / square * row->y;
    twist->z -= along / square * row->z;
}

/* The twist next to the given one that the carriage's own wheels allow, which scaled numbers seldom are. */
static void set_twist(laconic_node_hinges *hinges, const laconic_real twist[3]) {
    const laconic_articulated_model *m = &hinges->model;
    laconic_vector at_com = {twist[0] - twist[2] * m->com_y_m, twist[1] + twist[2] * m->com_x_m, twist[2]};
    for (int32_t k = 0; k < m->held_count; k++) roll_along(&at_com, &m->held[k]);
    hinges->input[1].twist[0] = at_com.x + at_com.z * m->com_y_m;
    hinges->input[1].twist[1] = at_com.y - at_com.z * m->com_x_m;
    hinges->input[1].twist[2] = at_com.z;
}

#define TWIST_PAGE 6U

#if LACONIC_NODE_WITH_SLIP
/* Where a hinge takes its command on ground with friction: a voltage, a rate, or the angle of a servo or loop; NULL:
 * none of that kind. */
static laconic_real *target_of(laconic_node_hinges *hinges, bool voltages, int32_t b) {
    const laconic_tree_model *m = &hinges->tree_model;
    const laconic_tree_body *body = &m->body[b + 1];
    if (voltages) return m->motor[m->wheel_count + b].gain_Nm_per_V != 0 ? &hinges->input[0].hinge_voltage_V[b] : NULL;
    if (body->servo_gain_Nm_per_rad != 0 || body->loop_V_per_rad != 0) return &hinges->angle_rad[b];
    const bool rates = body->servo_damping_Nms != 0 || body->loop_Vs_per_rad != 0;
    return rates || body->hinge == LACONIC_HINGE_PRESCRIBED ? &hinges->input[0].hinge_rate_rad_per_s[b] : NULL;
}

/* As set_three; a voltage acts at once, and so does a target. */
static bool set_three_targets(laconic_node_hinges *hinges, bool voltages, int32_t first, const laconic_real number[3]) {
    laconic_real *to[3] = {NULL, NULL, NULL};
    if (first >= hinges->model.body_count) return false;
    for (int32_t k = 0; k < 3; k++) {
        if (first + k < hinges->model.body_count) to[k] = target_of(hinges, voltages, first + k);
        if (number[k] != 0 && to[k] == NULL) return false;
    }
    for (int32_t k = 0; k < 3; k++)
        if (to[k] != NULL) *to[k] = number[k];
    return true;
}
#endif

/* Three rates or voltages from a hinge on. False iff a number is for none, or one that takes no such command. */
static bool set_three(laconic_node_hinges *hinges, bool voltages, int32_t first, const laconic_real number[3]) {
    const laconic_articulated_model *m = &hinges->model;
    if (first >= m->body_count) return false;
    for (int32_t k = 0; k < 3; k++) {
        const bool is_one = first + k < m->body_count;
        const laconic_link *link = &m->link[is_one ? first + k : 0];
        const bool has_effect = voltages ? link->gain_Nm_per_V != 0 : link->motion == LACONIC_MOTION_PRESCRIBED;
        if (number[k] != 0 && !(is_one && has_effect)) return false;
    }
    for (int32_t k = 0; k < 3 && first + k < m->body_count; k++) {
        if (voltages) hinges->input[0].hinge_voltage_V[first + k] = number[k];
        *(voltages ? &hinges->input[1].hinge_voltage_V[first + k] : &hinges->input[1].hinge_rate_rad_per_s[first + k]) =
            number[k];
    }
    return true;
}

bool laconic_node_take_steering(laconic_node *node, uint8_t page, const int16_t raw[3]) {
    const bool voltages = page >= 3U;
    const int32_t per_unit = page == TWIST_PAGE ? LACONIC_WIRE_STEERING_TWIST_1_PER_UNIT
                             : voltages         ? LACONIC_WIRE_STEERING_HINGE_VOLTAGE_1_PER_UNIT
                                                : LACONIC_WIRE_STEERING_HINGE_RATE_1_PER_UNIT;
    laconic_real number[3];
    for (int k = 0; k < 3; k++) number[k] = (laconic_real)raw[k] / (laconic_real)per_unit;
    if (!node->hinges.here || page > TWIST_PAGE || (page == TWIST_PAGE && !node->hinges.model.coordinated))
        return false;
#if LACONIC_NODE_WITH_SLIP
    if (node->hinges.slips) return set_three_targets(&node->hinges, voltages, 3 * (int32_t)(page % 3U), number);
#endif
    if (page == TWIST_PAGE) {
        set_twist(&node->hinges, number);
    } else if (!set_three(&node->hinges, voltages, 3 * (int32_t)(page % 3U), number)) {
        return false;
    }
    node->hinges.changes = true;
    return true;
}

/* --------------------------------------------------------------------------------------- steps -- */

static laconic_status step_along(laconic_node *node, const laconic_articulated_input *from,
                                 const laconic_articulated_input *to, laconic_refusal *why) {
    laconic_node_hinges *hinges = &node->hinges;
    const laconic_status status =
        laconic_articulated_step(&hinges->model, &hinges->integrator, &hinges->state, from, to, why);
    if (status != LACONIC_OK) return status;
    memcpy(hinges->twist, to->twist, sizeof hinges->twist);
    node->plant.steps++;
    return status;
}

/* One step along both inputs, after which those of its end act. */
static laconic_status step_between(laconic_node *node, laconic_refusal *why) {
    laconic_articulated_input *input = node->hinges.input;
    laconic_articulated_ramp(&input[0], &input[1], node->hinges.integrator.step_s);
    const laconic_status status = step_along(node, &input[0], &input[1], why);
    if (status != LACONIC_OK) return status;
    hold(&input[1]);
    input[0] = input[1];
    node->hinges.changes = false;
    return status;
}

#if LACONIC_NODE_WITH_SLIP
/* Steps under the held input. */
static laconic_status step_tree(laconic_node *node, uint64_t steps, laconic_refusal *why) {
    laconic_node_hinges *hinges = &node->hinges;
    laconic_tree_input input = {.hinged = hinges->input[0]};
    laconic_status status = LACONIC_OK;
    memcpy(input.hinge_angle_rad, hinges->angle_rad, sizeof input.hinge_angle_rad);
    for (; steps > 0 && status == LACONIC_OK; steps--) {
        status = laconic_tree_step(&hinges->tree_model, hinges->integrator.step_s, &hinges->tree, &input, why);
        if (status == LACONIC_OK) node->plant.steps++;
    }
    return status;
}
#endif

laconic_status laconic_node_step_hinges(laconic_node *node, uint64_t steps, laconic_refusal *why) {
    laconic_articulated_input *input = node->hinges.input;
    laconic_status status = LACONIC_OK;
    for (int k = 0; k < 2; k++) input[k].base = node->input[0];
#if LACONIC_NODE_WITH_SLIP
    if (node->hinges.slips) return step_tree(node, steps, why);
#endif
    if (!node->hinges.changes) {
        input[1] = input[0];
    } else if (steps > 0) {
        status = step_between(node, why);
        steps--;
    }
    for (; steps > 0 && status == LACONIC_OK; steps--) status = step_along(node, &input[0], &input[0], why);
    return status;
}

laconic_status laconic_node_step_hinges_sampled(laconic_node *node, laconic_refusal *why) {
    for (int k = 0; k < 2; k++) node->hinges.input[k].base = node->input[k];
    return step_between(node, why);
}

/* ------------------------------------------------------------------------------------- outputs -- */

void laconic_node_motion_of(laconic_articulated_motion *motion, const laconic_node *node) {
#if LACONIC_NODE_WITH_SLIP
    if (node->hinges.slips) {
        laconic_tree_motion_of(motion, &node->hinges.tree_model, &node->hinges.tree);
        return;
    }
#endif
    laconic_articulated_motion_of(motion, &node->hinges.model, &node->hinges.state);
}

void laconic_node_collect_hinges(laconic_raw_output *raw, const laconic_node *node) {
    laconic_articulated_motion motion;
    laconic_node_motion_of(&motion, node);
    laconic_raw_collect_hinges(raw, &motion, node->hinges.model.wheel_count, node->hinges.model.body_count,
                               &node->input[0]);
}

#else
typedef int laconic_node_has_no_hinges; /* a file without a declaration is no C */
#endif
