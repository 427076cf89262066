/* The controller: feedback in, loops, a command each period. */
#include <string.h>

#include "model_interface.h"

enum { COMMAND = 0x200, FIRST_FEEDBACK = 0x201 };
#define FULL_SCALE 16384.0
#define FULL_SCALE_A 20.0
#define RAD_PER_S_PER_RPM 0.10471975511965977
#define ROUNDING 1e-9 /* of a period */

void fmu_model_made(fmu_model *model) { (void)model; }

bool fmu_model_take_private(fmu_instance *instance, uint32_t reference, uint64_t bits) {
    (void)instance;
    (void)reference;
    (void)bits;
    return false;
}

fmu_status fmu_model_start(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    if (!network_may_start(instance)) return FMU_ERROR;
    if (self->gear_ratio == 0.0) return fmu_refuse(instance, "gear_ratio: 0 turns no wheel; give another one");
    memset(self->port, 0, sizeof self->port);
    for (unsigned k = 0; k < MOTORS; k++) self->measured_rad_per_s[k] = self->error_rad[k] = self->current_A[k] = 0.0;
    self->start_s = instance->clock.start_s;
    self->periods = 0;
    self->is_due = false;
    can_controller_start(&self->can, &self->port[0].tx);
    network_ports_make_due(self->port, FMU_MODEL_PORTS);
    self->start_needed = self->change_needed = false;
    return FMU_OK;
}

void fmu_model_refresh(fmu_instance *instance, uint32_t groups) {
    (void)instance; /* outputs are those of the last frame */
    (void)groups;
}

/* ------------------------------------------------------------------------------------------ frames -- */

static void take_feedback(fmu_model *self, const laconic_frame *frame) {
    const uint32_t motor = frame->id - FIRST_FEEDBACK;
    if (frame->extended || frame->remote || frame->fd || frame->length != 8 || motor >= MOTORS) return;
    const int16_t rpm = (int16_t)(frame->data[2] << 8 | frame->data[3]);
    self->measured_rad_per_s[motor] = (double)rpm * RAD_PER_S_PER_RPM / self->gear_ratio;
}

void fmu_model_receive(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    network_port *port = &self->port[0];
    const uint64_t now_us = (uint64_t)((self->time_s - self->start_s) * 1e6 + 0.5);
    ls_bus_operation operation;
    ls_bus_reading reading;
    size_t at = 0;
    if (!port->rx_clock) return;
    while ((reading = ls_bus_read(port->rx.bytes, port->rx.size, &at, &operation)) != LS_BUS_END)
        if (can_controller_hear(&self->can, &port->tx, reading, &operation, now_us))
            take_feedback(self, &operation.frame);
}

static double control(fmu_model *self, unsigned k) {
    const double error = self->gear_ratio * (self->setpoint_rad_per_s[k] - self->measured_rad_per_s[k]);
    const double wanted_A = self->proportional_As_per_rad * error + self->integral_A_per_rad * self->error_rad[k];
    const double limit_A = self->limit_A;
    const bool is_held = (wanted_A > limit_A && error > 0.0) || (wanted_A < -limit_A && error < 0.0);
    if (!is_held) self->error_rad[k] += error * self->period_s;
    return wanted_A > limit_A ? limit_A : wanted_A < -limit_A ? -limit_A : wanted_A;
}

static void command(fmu_model *self) {
    laconic_frame frame = {.id = COMMAND, .length = 8};
    for (unsigned k = 0; k < MOTORS; k++) {
        const double scaled = self->current_A[k] * (FULL_SCALE / FULL_SCALE_A);
        const int32_t raw = (int32_t)(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
        frame.data[2 * k] = (uint8_t)((uint32_t)raw >> 8 & 255U);
        frame.data[2 * k + 1] = (uint8_t)((uint32_t)raw & 255U);
    }
    can_controller_send(&self->can, &self->port[0].tx, &frame);
    self->is_due = false;
}

/* ------------------------------------------------------------------------------------------- time -- */

/* A command that still waits when the next one comes is replaced by it. */
void fmu_model_advance(fmu_instance *instance, double end_s) {
    fmu_model *self = &instance->model;
    ls_bus_buffer *tx = &self->port[0].tx;
    const double wanted = (end_s - self->start_s) / self->period_s + ROUNDING;
    while ((double)(self->periods + 1) <= wanted) {
        self->periods++;
        for (unsigned k = 0; k < MOTORS; k++) self->current_A[k] = control(self, k);
        self->is_due = true;
        if (can_controller_is_free(&self->can, tx)) command(self);
    }
    can_controller_tick(&self->can, tx, (uint64_t)((end_s - self->start_s) * 1e6 + 0.5));
    if (self->is_due && can_controller_is_free(&self->can, tx)) command(self);
}

double fmu_model_countdown(const fmu_instance *instance) {
    const fmu_model *self = &instance->model;
    const double next_s = self->start_s + (double)(self->periods + 1) * self->period_s - self->time_s;
    const bool is_ready = self->port[0].tx.size > self->port[0].offered;
    return is_ready || next_s < 1e-6 ? 1e-6 : next_s;
}
