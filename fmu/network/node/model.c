/* The node as an FMU model: it is loaded as by a rig, hears operations, and ticks at the instants it asks for. */
#include <string.h>

#include "model_interface.h"

#define FRAME_BYTES 8U
#define TAKEN_BASES 255U /* behind the offsets of frames: the private start value of fmu_model.taken_bases */

void fmu_model_made(fmu_model *model) { (void)model; }

/* A frame of the rig (model.h): the reference gives its place in the order, the offset of its identifier its value. */
bool fmu_model_take_private(fmu_instance *instance, uint32_t reference, uint64_t bits) {
    fmu_model *self = &instance->model;
    const uint32_t offset = reference - FMU_PRIVATE_START;
    if (offset == TAKEN_BASES) {
        self->taken_bases = bits;
        return true;
    }
    if (offset >= LACONIC_WIRE_RIG_OFFSETS || self->frame_count >= NETWORK_NODE_FRAMES) return false;
    network_node_frame *frame = &self->frame[self->frame_count++];
    frame->offset = (uint8_t)offset;
    for (unsigned k = 0; k < FRAME_BYTES; k++) frame->data[k] = (uint8_t)(bits >> (8U * k) & 255U);
    return true;
}

static network_port *port_of(fmu_instance *instance) { return &instance->model.port[0]; }

/* The drives' memory is a part of the node, which may have been copied. */
static laconic_node *node_of(fmu_instance *instance) {
    laconic_node *node = &instance->model.node;
    if (node->drives.axes != NULL) node->drives.axes = node->axes;
    return node;
}

/* Frames of the node to the bus, as many as the controller takes now; the others wait in the node. */
static void fetch(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    ls_bus_buffer *tx = &port_of(instance)->tx;
    laconic_frame frame;
    while (can_controller_is_free(&self->can, tx) && laconic_node_next_frame(&self->node, &frame))
        can_controller_send(&self->can, tx, &frame);
    if (self->is_full || ls_bus_has_room(tx, 2 * LS_BUS_LARGEST_OPERATION)) return;
    self->is_full = true;
    fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING,
            "CAN.Tx_Data is full at %.9g s: more frames wait in the node; take shorter communication steps",
            (double)self->now_us * 1e-6 + self->start_s);
}

/* What the rig of the scene would have sent, and the answers that it would have read. The frames of drives that then
 * come first, such as a boot-up message, stay for the bus. */
static bool load(fmu_model *self) {
    laconic_frame answer;
    for (uint32_t k = 0; k < self->frame_count; k++) {
        laconic_frame frame = {.id = (uint32_t)self->id_base + self->frame[k].offset, .length = FRAME_BYTES};
        memcpy(frame.data, self->frame[k].data, FRAME_BYTES);
        laconic_node_on_frame(&self->node, &frame, 0);
        while (self->node.pending != 0) laconic_node_next_frame(&self->node, &answer);
    }
    return self->frame_count == 0 || self->node.state == LACONIC_WIRE_STATE_READY ||
           self->node.state == LACONIC_WIRE_STATE_DRIVES;
}

fmu_status fmu_model_start(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    const laconic_node_config config = {(uint16_t)self->id_base, self->can.fd_bit_rate_bit_per_s > 0,
                                        laconic_method_by_number, 0, laconic_drive_protocol_by_number};
    if (!network_may_start(instance)) return FMU_ERROR;
    if (self->can.drops_lost && !self->can.discards)
        return fmu_refuse(instance, "drop_lost_frames: has no effect without discard_on_lost_arbitration; set both");
    if (!laconic_node_init(&self->node, &config, 0))
        return fmu_refuse(instance, "id_base: %d is no multiple of 32 from 0 to 2016", (int)self->id_base);
    if (self->taken_bases >> ((unsigned)self->id_base / LACONIC_NODE_ID_STRIDE) & 1U)
        return fmu_refuse(instance, "id_base: the drives use identifiers from %d to %d; give another multiple of 32",
                          (int)self->id_base, (int)self->id_base + (int)LACONIC_NODE_ID_STRIDE - 1);
    if (!load(self))
        return fmu_refuse(instance, "the scene in resources/start.bin cannot be loaded; make the FMU anew");
    self->start_s = instance->clock.start_s;
    self->now_us = 0;
    self->is_full = false;
    memset(self->port, 0, sizeof self->port);
    can_controller_start(&self->can, &port_of(instance)->tx);
    fetch(instance);
    network_ports_make_due(self->port, FMU_MODEL_PORTS);
    self->start_needed = self->change_needed = false;
    self->stale = FMU_GROUPS_ALL;
    return FMU_OK;
}

/* ------------------------------------------------------------------------------------------ the bus -- */

void fmu_model_receive(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    network_port *port = port_of(instance);
    laconic_node *node = node_of(instance);
    ls_bus_operation operation;
    ls_bus_reading reading;
    size_t at = 0;
    if (!port->rx_clock) return;
    while ((reading = ls_bus_read(port->rx.bytes, port->rx.size, &at, &operation)) != LS_BUS_END) {
        if (can_controller_hear(&self->can, &port->tx, reading, &operation, self->now_us))
            laconic_node_on_frame(node, &operation.frame, (uint32_t)self->now_us);
        fetch(instance);
    }
}

/* Forces of the importer act while drives play; otherwise inputs are the rig's. */
static void set_inputs(fmu_model *self) {
    laconic_input *input = &self->node.input[0];
    if (self->node.state != LACONIC_WIRE_STATE_DRIVES) return;
    for (unsigned k = 0; k < 2; k++) input->body_force_N[k] = self->body_force_N[k];
    input->body_moment_Nm = self->body_moment_Nm;
}

static void tick(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    const uint8_t before = self->node.state;
    set_inputs(self);
    laconic_node_on_tick(&self->node, (uint32_t)self->now_us);
    can_controller_tick(&self->can, &port_of(instance)->tx, self->now_us);
    fetch(instance);
    if (self->node.state == LACONIC_WIRE_STATE_FAULT && before != LACONIC_WIRE_STATE_FAULT)
        fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING,
                "the core refused a step at %.9g s: the node is in state fault until a rig resets it",
                (double)self->now_us * 1e-6 + self->start_s);
}

/* Microseconds until the node or its controller has something to do. */
static uint64_t idle_us(const fmu_model *self) {
    const uint64_t idle = laconic_node_idle_us(&self->node, (uint32_t)self->now_us);
    if (self->can.status != LS_BUS_BUS_OFF || self->can.off_until_us >= self->now_us + idle) return idle;
    return self->can.off_until_us - self->now_us; /* it is to come: the last tick would have ended it */
}

void fmu_model_advance(fmu_instance *instance, double end_s) {
    fmu_model *self = &instance->model;
    const double passed_us = (end_s - self->start_s) * 1e6 + 0.5;
    const uint64_t end_us = passed_us > (double)self->now_us ? (uint64_t)passed_us : self->now_us;
    node_of(instance);
    for (;;) {
        tick(instance);
        const uint64_t idle = idle_us(self);
        if (idle > end_us - self->now_us) break;
        self->now_us += idle;
    }
    self->now_us = end_us;
}

/* A frame that is ready can go at once: a microsecond is the resolution of the node's clock. */
double fmu_model_countdown(const fmu_instance *instance) {
    const fmu_model *self = &instance->model;
    const uint64_t idle = self->port[0].tx.size > self->port[0].offered ? 0 : idle_us(self);
    return (double)(idle > 0 ? idle : 1) * 1e-6;
}

/* ------------------------------------------------------------------------------------------ outputs -- */

static void show_wheels(fmu_model *self) {
    laconic_real speed[LACONIC_MAX_WHEELS];
    laconic_real angle[LACONIC_MAX_WHEELS];
    const int32_t count = self->node.plant.model.wheel_count;
    laconic_plant_wheel_speeds(&self->node.plant, speed);
    laconic_plant_wheel_angles(&self->node.plant, angle);
    for (int32_t k = 0; k < count && k < self->wheel_count; k++) {
        self->wheel_speed_rad_per_s[k] = speed[k];
        self->wheel_angle_rad[k] = angle[k];
        self->axle_torque_Nm[k] = self->node.input[0].axle_torque_Nm[k];
    }
}

void fmu_model_refresh(fmu_instance *instance, uint32_t groups) {
    fmu_model *self = &instance->model;
    const laconic_plant *plant = &self->node.plant;
    laconic_pose pose;
    groups &= self->stale;
    self->stale &= ~groups;
    self->node_state = self->node.state;
    if (groups == 0 || self->node.state == LACONIC_WIRE_STATE_EMPTY) return; /* without a vehicle all are 0 */
    laconic_pose_of(&pose, &plant->model, &plant->state);
    self->x_m = pose.x_m;
    self->y_m = pose.y_m;
    self->heading_rad = pose.heading_rad;
    self->yaw_rate_rad_per_s = laconic_body_velocity(&plant->model, &plant->state, self->velocity_m_per_s);
    laconic_nu(&plant->model, &plant->state, self->nu);
    show_wheels(self);
}
