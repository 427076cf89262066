/* The drives of one vehicle between a protocol and the plant. A step of all of them is
 *
 *     protocol->on_step;  torque of each drive, held;  laconic_plant_run, one step;  measured motion of each wheel
 *
 * so the plant moves as one that is fed with these torques, bit for bit. */
#ifndef LACONIC_DRIVES_DRIVES_H
#define LACONIC_DRIVES_DRIVES_H

#include "laconic_drives/settings.h"
#if LACONIC_NODE_WITH_HINGES
#include "laconic/articulated.h"
#endif
#if LACONIC_NODE_WITH_SLIP
#include "laconic/articulated_friction.h"
#endif

/* As after power-up, from a plan that laconic_drive_plan_check() has accepted: every drive is off at count 0 and
 * measures its wheel's speed. `axes`: memory for protocol->axis_bytes of each drive, aligned to 8 bytes. */
void laconic_drives_start(laconic_drives *drives, const laconic_drive_plan *plan,
                          const laconic_drive_protocol *protocol, void *axes, const laconic_plant *plant,
                          uint32_t now_us);

/* A frame from the bus, for the protocol. */
void laconic_drives_on_frame(laconic_drives *drives, const laconic_frame *frame, uint32_t now_us);

/* One step of the plant with which the drives were started. Writes the axle torques of the wheels that have a drive
 * into `held` and leaves its other numbers. A refusal is that of laconic_plant_run; the drives are then off. */
laconic_status laconic_drives_step(laconic_drives *drives, laconic_plant *plant, laconic_input *held, uint32_t now_us,
                                   laconic_refusal *why);

#if LACONIC_NODE_WITH_HINGES
/* The same for a vehicle with hinges. */
void laconic_drives_start_with_hinges(laconic_drives *drives, const laconic_drive_plan *plan,
                                      const laconic_drive_protocol *protocol, void *axes,
                                      const laconic_articulated_model *model, const laconic_articulated_state *state,
                                      laconic_real step_s, uint32_t now_us);

/* Before a step: writes the axle torques of wheels into `held`, and of steering axes the torque into both inputs, or
 * the rate of a prescribed one into that of the end. The step then runs from one input to the other. */
void laconic_drives_act_with_hinges(laconic_drives *drives, const laconic_articulated_model *model, laconic_input *held,
                                    laconic_articulated_input input[2], uint32_t now_us);

/* After it: what the encoders show. */
void laconic_drives_measure_with_hinges(laconic_drives *drives, const laconic_articulated_model *model,
                                        const laconic_articulated_state *before,
                                        const laconic_articulated_state *after);
#endif

#if LACONIC_NODE_WITH_SLIP
/* The same on ground with friction. laconic_drives_act_with_hinges serves there, too: of its model it reads the number
 * of wheels and which hinges are prescribed. The step holds the input of the end. */
void laconic_drives_start_slipping(laconic_drives *drives, const laconic_drive_plan *plan,
                                   const laconic_drive_protocol *protocol, void *axes, const laconic_tree_model *model,
                                   const laconic_tree_state *state, laconic_real step_s, uint32_t now_us);

void laconic_drives_measure_slipping(laconic_drives *drives, const laconic_tree_model *model,
                                     const laconic_tree_state *before, const laconic_tree_state *after);

/* Brakes by order are dry friction that no drive and no ground overcomes. Exchanges the dry friction of each axle and
 * hinge that such a brake holds with `other_Nm` of its drive: a step stands between two calls, of which the first one
 * gets laconic_drives_brakes and the second one what the first one left. */
void laconic_drives_exchange_dry_friction(const laconic_drives *drives, laconic_tree_model *model,
                                          laconic_real other_Nm[LACONIC_DRIVE_AXES]);

/* The torque of each drive's brake by order. False iff there is none. */
bool laconic_drives_brakes(const laconic_drives *drives, laconic_real brake_Nm[LACONIC_DRIVE_AXES]);
#endif

/* The next frame of the protocol; false iff there is none. */
bool laconic_drives_next_frame(laconic_drives *drives, laconic_frame *frame);

/* The torque of a brake by order at the axle of `wheel`: what stops the wheel within the step against the drive, as far
 * as the brake is strong enough. `share`: brakes act on one body, so each takes its part, 1 over their count. */
laconic_real laconic_drive_brake(const laconic_wheel_drive *drive, const laconic_plant *plant, int32_t wheel,
                                 laconic_real speed_rad_per_s, laconic_real share);

/* Every drive off. */
void laconic_drives_off(laconic_drives *drives);

#endif
