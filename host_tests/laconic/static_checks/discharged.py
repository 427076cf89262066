"""Alarms of the analyser that cannot happen, each with its argument."""

from __future__ import annotations

from typing import NamedTuple

E, H, M = "core_c/src/elementary.c", "core_c/src/heading.h", "core_c/src/message.c"
PANELS, PANELS_H = "core_c/src/exponential_gauss_8.c", "core_c/src/exponential_gauss_8.h"
L, WATCH = "firmware_stub/src/loader.c", "firmware_stub/src/integrity.c"
CONVERSION, UNSET = "", "uninitialized"
OF_N = "written for each wheel of the same model in the lines before; both loops run to the same wheel_count"
ROTATES = ("cosine and sine of a forcing, and what is made of them, are read only where its flag `rotates` is "
           "set; the function that sets the flag sets them, too. The analyser forgets that both go together")

FILLED = ("a function that returns LACONIC_OK has filled the struct it is given, and the caller reads it then alone; "
          "the analyser merges its returns")
STRETCHES = "choose_panels() leaves at most MOST_STRETCHES in a prepared integrator, and no other function writes it"
PLACE = ("find() refuses an item beyond its field's; offset + stride · (item − 1) is then the place of that item in "
         "laconic_parameters, of the field's own type. The analyser knows offset, stride and items only one by one")
WITH_MODEL = ("prove_matrices", "prove_contact_prepare")
OF_PLANT = ("prove_plant_start", "prove_slip_set", "prove_plant_restart_slipping", "prove_plant_change")
STEPS_OF_FRICTION = tuple(f"prove_friction_step_{wheels}" for wheels in range(17))
OF_FRICTION = ("prove_friction_moment", "prove_slip_set", "prove_sensors_read", "prove_plant_outputs",
               "prove_plant_restart_slipping", "prove_follow", "prove_record_row", *STEPS_OF_FRICTION)
POINTS = ("loads and forces are written for each of the point_count points, or of the wheel_count wheels, before; the "
          "points are the wheels, then the supports")
FRAMES = ("prove_frames",)
OF_ENCODER = ("ENCODER is pending only while encoder_wheel names a wheel with an encoder: "
              "laconic_node_publish_sensors(), laconic_node_start_sensors() and has_more() set both")
OF_PART = ("as many bytes as `count` says are left of a part, whose offset and size are those of a member of "
           "laconic_node")
GROUP = ("the group is 0 where its frame becomes pending, and has_more() lets it grow only while three times it is "
         "below the wheels of a vehicle, at most LACONIC_MAX_WHEELS; the array has three more")
RANK = ("the second row of a contact, and what is made of it, is read only where its rank is 2, and written where that "
        "is set. The analyser forgets that both go together")
STEPS = ("rk4", "exponential_kahan", "exponential_kahan_4", "exact_flow", "exact_flow_4", "taylor_8",
         "exponential_gauss_8", "auto")
REFUSED = tuple(f"prove_refused_{name}" for name in STEPS)
METHODS = (*REFUSED, *(f"prove_{name}" for name in (
    *STEPS, "reactions", "outputs", "plant_run", "plant_outputs", "sensors_read", "plant_run_slipping",
    "sensors_start", "sensors_run", "follow", "record_row", "estimate_start", "estimate_run", "estimate_carry",
    "estimate_follow", "derivatives_of_rk4")))
OF_ESTIMATE = tuple(f"prove_estimate_{name}" for name in ("start", "carry", "run", "follow"))
OF_DRIVES = ("prove_drives_by_odrive", "prove_drives_by_robomaster")
OF_DERIVATIVES = ("prove_derivatives_of_rk4",)
TAKEN = ("laconic_take_step() fills a step where it returns LACONIC_OK, and its callers return where it does not: the "
         "analyser merges both. Columns are set for ν, force and moment, and for the parts of b where it rotates; "
         "where it does not, nothing is read of the latter nor of what is made of them")
RUNS = ("prove_sensors_run", "prove_follow", *OF_ESTIMATE)
COUNTED = (*RUNS, *OF_DRIVES)
SAMPLED = ("sample_at() and laconic_schedule_at() write every number of the inputs that are read; the analyser joins "
           "the rounds of their loops, and forgets that as many inputs are read as were written")
FINITE = ("frames with a number that is not finite are passed over, and products of finite numbers are no NaN: what is "
          "beyond the bound is held at it")
RECORDED = ("prove_follow", "prove_record_row")


PLACES_OF_STEPS = {
    "core_c/derivatives/step_derivatives.c": (
        "const int columns = s->at.rotates",
        "s->responds(&s->result",
        "heading_rad + R(0.5) * by->yaw_change_rad",
        "s->middle.cosine * by->along_m",
        "const real x = weight.x",
        "to[i] = x * a[i]",
        "to[i] += from[i]",
        "const laconic_model *m = s->at.model;",
        "to[i] = factor * from[i]",
    ),
    "core_c/derivatives/rk4_change.c": (
        "at->integrator->step_s",
        "*m = at->model",
        "if (at->rotates)",
    ),
    "core_c/src/vector.h": (
        "dot(vector a, vector b)",
        "factor * v.x",
        "a.y * b.z - a.z * b.y",
        "{a.x * b.x, a.y",
    ),
    "core_c/derivatives/direction_lanes.h": (
        "lanes_with(a.x + b.x",
        "lanes_dot(vector a",
    ),
    "core_c/derivatives/step_chain.h": (
        "heading.cosine, b.cosine",
        "s->at.model->nu_of_zeta",
    ),
    "core_c/derivatives/step_adjoint.c": (
        "s->at.heading.cosine",
        "a->x_m * b->x_m",
        "a->wheel_angle_rad[i]",
    ),
}
"""Lines of the derivatives of a step, whose alarms have one argument."""


class Argument(NamedTuple):
    """Why alarms at one place cannot happen: `part` of the source line, `kind` part of the alarm; of these entries
    alone, where any are named."""

    file: str
    part: str
    kind: str
    why: str
    entries: tuple[str, ...] = ()

    def meets(self, entry: str, file: str, code: str, what: str) -> bool:
        """Whether it is about this alarm."""
        here = file == self.file and self.part in code and self.kind in what
        return here and (not self.entries or entry in self.entries)


DISCHARGED: tuple[Argument, ...] = (
    Argument("core_c/src/common.h", "sum->rest = wanted", "out of bounds write",
             "meant to be seen: the state of these entries cannot be written to. This is the first write of "
             "accept_step(), after the last place at which a step is refused", REFUSED),
    Argument("core_c/src/state.c", "*state = carried;", "out of bounds write",
             "meant to be seen: the state of this entry cannot be written to. The next line accepts",
             ("prove_refused_carry",)),
    Argument("core_c/src/record.c", "assert middle < schedule->count", "assertion",
             "proved by WP in the room schedules"),
    Argument("core_c/src/record.c", "*number_at(now, recorder->column[k])", UNSET,
             "columns name numbers that laconic_outputs has for this plant, of wheels that it has, as laconic.h asks; "
             "outputs, reactions and sensors have filled those", RECORDED),
    Argument("core_c/src/contact.c", "out->along_N[i] * c->pull", UNSET, OF_N, RECORDED),
    Argument("core_c/src/contact.c", "r->along_N[i] * r->along_N[i]", UNSET, OF_N, RECORDED),
    Argument("core_c/src/contact.c", "c->friction_coefficient * out->normal_N[i]", UNSET, POINTS, RECORDED),
    Argument("core_c/src/grip.c", "r->along_N[wheel] * r->along_N[wheel]", UNSET, OF_N, RECORDED),
    Argument("core_c/src/grip.c", "r->normal_N[", UNSET, POINTS, RECORDED),
    Argument("core_c/src/encoder.c", "(now->value - before->value)", UNSET,
             "laconic_odometer_of() has filled it for each wheel of the same plant before the step", COUNTED),
    Argument("core_c/src/imu.c", "old = before->yaw_rate_rad_per_s", "out of bounds read",
             "`before` is NULL only where laconic_sensors_run() watches no single step, and watches_each_step() holds "
             "for a plant with friction, of which alone it is read", RUNS),
    Argument(H, "const int64_t turns = heading->turns +", "signed overflow",
             "a heading has at most 2⁶³ − 2 turns: a step begins within 2⁶² and adds less than 2⁶²", RUNS),
    Argument(E, "(int)(a * R(1.4426950408889634)", "overflow in conversion",
             "a is h·r, and rates of a model are not negative", OF_ESTIMATE),
    Argument("core_c/estimate/estimate.c", "farthest = larger_of(farthest, magnitude(angle[i]))", UNSET, OF_N,
             OF_ESTIMATE),
    Argument("core_c/estimate/estimate.c", "estimate->taken += (int32_t)steps", "signed overflow",
             "steps are at most the length less those taken, which laconic_estimate_before() has told", OF_ESTIMATE),
    Argument("core_c/estimate/estimate.c", "(uint64_t)(estimate->length - estimate->taken)", "signed overflow",
             "both are from 0 to LACONIC_ESTIMATE_MOST, and a window that is full has been ended before", OF_ESTIMATE),
    Argument("core_c/src/step.c", "middle->world_force_N[0] + middle", UNSET, SAMPLED, OF_ESTIMATE),
    Argument("core_c/src/step_internals.h", "input->world_force_point_m[0] + input", UNSET, SAMPLED, OF_ESTIMATE),
    Argument("core_c/src/step_internals.h", "in->axle_torque_Nm[i]", UNSET, SAMPLED, OF_ESTIMATE),
    Argument("core_c/src/step_internals.h", "in->voltage_V[i]", UNSET, SAMPLED, OF_ESTIMATE),
    Argument("core_c/src/step_internals.h", "m->torque_scale * in->world_force_N[0]", UNSET, SAMPLED, OF_ESTIMATE),
    Argument("core_c/src/step_internals.h", "scaled(r[", UNSET, SAMPLED, OF_ESTIMATE),
    Argument("core_c/estimate/estimate.c", "numbers_of(", UNSET, SAMPLED, OF_ESTIMATE),
    Argument("core_c/src/step_internals.h", "acts(input->body_force_N[0]", UNSET, SAMPLED, OF_ESTIMATE),
    Argument("core_c/src/step_internals.h", "acts(input->world_force_N[0]", UNSET, SAMPLED, OF_ESTIMATE),
    Argument("firmware_stub/drives/robomaster/robomaster.c", "(int32_t)(bounded < 0", "non-finite",
             "neither a speed, the product of two finite numbers, is NaN, nor a current: laconic_drive_act() fails a "
             "drive whose current is", OF_DRIVES),
    Argument("firmware_stub/drives/drive.c", "laconic_encoder_place(&drive->encoder", "precondition",
             "laconic_drive_plan_check() refuses a drive whose encoder_counts are not positive", OF_DRIVES),
    Argument("firmware_stub/drives/place.c", "(int32_t)turns", "non-finite", FINITE, OF_DRIVES),
    Argument("firmware_stub/drives/place.c", "(int32_t)real_within(about", "non-finite",
             "a count, divided by encoder_counts, which are positive, is finite", OF_DRIVES),
    Argument("firmware_stub/drives/odrive/odrive_control.c", "modes[axis->control_mode]", "out of bounds",
             "odrive_supervise() comes before it and disarms an axis whose control mode is none of the three",
             OF_DRIVES),
    Argument("firmware_stub/drives/odrive/odrive_control.c", "axis->place = axis->input_place", "overlapping",
             "both are members of one struct, at different places", OF_DRIVES),
    Argument("firmware_stub/drives/odrive/odrive_messages.c", "fills[command](", "function",
             "a command becomes pending only where odrive_sends() holds, or by its name among those that are sent",
             OF_DRIVES),
    Argument(WATCH, "memcpy(word, bytes, sizeof word", "precondition", OF_PART, ("prove_integrity",)),
    Argument(WATCH, "(uint32_t)bytes[k]", "out of bounds", OF_PART, ("prove_integrity",)),
    Argument(WATCH, "LACONIC_INTEGRITY_ROUND_US / slices_of_a_round()", "division",
             "the parts of a model have bytes, so a round has slices", ("prove_integrity",)),
    Argument(WATCH, "here->size - it->at", "out of bounds",
             "see_slice() begins a new round as soon as the part it comes to is beyond the last", ("prove_integrity",)),
    Argument("core_c/src/state.c", "to->com_x_m - from->com_x_m", UNSET, FILLED, ("prove_plant_change",)),
    Argument("core_c/src/state.c", "/ to->wheel_radius_m", UNSET, FILLED, ("prove_plant_change",)),
    Argument("core_c/src/state.c", "to->yaw_scale * yaw_rate", UNSET, FILLED, ("prove_plant_change",)),
    Argument("core_c/proof/core.c", "assert 0 <= vehicle.wheel_count", "assertion",
             "the second test of laconic_vehicle_check() refuses every other count; the analyser merges its returns"),
    Argument("core_c/proof/core.c", "assert 0 <= vehicle.support_count", "assertion",
             "the first test of check_supports(), by which laconic_vehicle_check() goes, refuses every other count"),
    Argument(E, "(int32_t)(quarters", CONVERSION,
             "quarters lies within ±10⁶ by the line before, by the function magnitude(); NaN and larger ones take the "
             "other way"),
    Argument(E, "(int)(a * R(1.4426950408889634)", "non-finite",
             "a < EXPONENT_SPAN in the line before, which NaN is not; a is h·r, and rates of a model are not negative"),
    Argument(E, "(real)(signed_binary_angle)turns", CONVERSION,
             "turns lies within ±2⁶³ (single: 2³¹) by the line before, by the function magnitude(); NaN takes the "
             "other way"),
    Argument(E, "(signed_binary_angle)(part * HALF_TURN)", CONVERSION,
             "part is a number less its whole part, so within ±(1 − 2⁻⁵³), and the product is at most 2⁶³ − 2¹⁰"),
    Argument(H, "const signed_binary_angle whole", CONVERSION,
             "all callers have refused yaw that is not below LARGEST_YAW_CHANGE_RAD, 2⁶⁴ rad, NaN included: 2.9·10¹⁸ "
             "turns, below 2⁶³"),
    Argument(H, "const signed_binary_angle half", CONVERSION,
             "turns − whole lies in (−1, 1), so its product with 2⁶³ is at most 2⁶³ − 2¹⁰; rest is within ±1 in every "
             "heading that the core has made, since it is what rounding to whole units left"),
    Argument(H, "heading->turns += whole", "signed overflow",
             "whole is within ±2.9·10¹⁸; steps begin within 2⁶² turns (heading_has_room) and a start with none, so the "
             "sum stays within 7.6·10¹⁸"),
    Argument("core_c/src/integrator.c", "step = why.limit", UNSET,
             "laconic_integrator_prepare() has refused, and each of its refusals fills the struct it is given"),
    Argument("core_c/src/integrator.c", "(uint64_t)ratio", "non-finite",
             "ratio is positive, since interval and step are, and below 9·10¹⁵ by the line before, which NaN is not"),
    Argument(M, "w->text[w->length] = c", "out of bounds",
             "length + 1 < size in the same line, and the text has room for size"),
    Argument(M, "exponent++", "signed overflow", "a finite number is divided by 10 at most 308 times"),
    Argument(M, "exponent--", "signed overflow", "a number above 0 is multiplied by 10 at most 324 times"),
    Argument(M, "-exponent : exponent", "signed overflow", "the exponent is within ±324"),
    Argument(M, "for (c = explanation(why->status)", "out of bounds", "explanations end with 0, where the loop ends"),
    Argument(M, "for (; *path != '\\0'; path++)", "out of bounds",
             "paths end with 0; past '[' two more letters are skipped, and every '[' of a path begins \"[#]\""),
    Argument("core_c/src/outputs.c", "angle_rad[i]", UNSET, OF_N),
    Argument("core_c/src/outputs.c", "torque_Nm[i] = model->motor_gain_Nm_per_V", UNSET, OF_N),
    Argument("core_c/src/state.c", "zero_if_finite(angle[i])", UNSET, OF_N),
    Argument("core_c/src/contact.c", "torque_Nm[i]", UNSET, OF_N),
    Argument("core_c/src/prepare.c", "row[k]", UNSET,
             "laconic_constraint_rows() fills as many rows as it returns, and only these are read"),
    Argument("core_c/src/taylor_8.c", "heading_sine", UNSET, ROTATES, METHODS),
    Argument("core_c/src/taylor_8.c", "heading_cosine", UNSET, ROTATES, METHODS),
    Argument("core_c/src/vector.h", "v[0], v[1], v[2]", UNSET, ROTATES, METHODS),
    Argument("core_c/src/vector.h", "a.x + b.x", UNSET, ROTATES, METHODS),
    Argument("core_c/src/vector.h", "v.x", UNSET, ROTATES, METHODS),
    Argument("firmware_stub/src/raw_frames.c", "raw->position / each", "division by zero",
             "laconic_raw_take() has refused where no number is chosen, by the same function of the same arguments"),
    Argument("firmware_stub/src/raw_frames.c", "assert 0 <= sample <= 2", "assertion",
             "position < 3·each while not complete, as it is complete at the last number, so position / each ≤ 2"),
    Argument("firmware_stub/src/raw_frames.c", "memcpy(to, raw->number", "precondition",
             "a slot is found for each number below numbers_of(), and position modulo each is one"),
    Argument("firmware_stub/src/slcan.c", "assert k == 0 ==> *value <= 15", "assertion",
             "proved by WP in the room slcan"),
    Argument("firmware_stub/src/raw_frames.c", "raw->number[raw->filled++]", "out of bounds",
             "filled becomes 0 in store() as soon as it reaches the size of a number"),
    Argument("firmware_stub/src/slcan.c", "*to++", "out of bounds",
             "1 + 8 + 1 + 2·64 + 1 letters are the line's length; a frame has at most LACONIC_FRAME_BYTES bytes (the "
             "box)"),
    Argument("firmware_stub/src/slcan.c", "(size_t)(to - text)", "signed overflow",
             "at most LACONIC_SLCAN_LINE letters"),
    Argument("firmware_stub/src/protection.c", "list_of(offset)[", "out of bounds",
             "a list has sixteen entries, and the index is masked to sixteen; only frames of CAN FD, which do not come "
             "here, have no list"),
    Argument(PANELS, "integrator->stretches++", "signed overflow",
             "the loop's condition ends it at MOST_STRETCHES, a small number"),
    Argument(PANELS_H, "parts_of(integrator) * integrator->stretches", "signed overflow", STRETCHES),
    Argument(PANELS_H, "k == parts * integrator->stretches", "signed overflow", STRETCHES),
    Argument(PANELS_H, "PHI(phi, j,", UNSET,
             "phis_at_nodes() fills φ0 … φ5 of all five points by two loops; the analyser merges their rounds"),
    Argument(M, "k++, divisor /= 10", "signed overflow", "the divisor has at most ten digits, so k stays below 11"),
    Argument("core_c/src/matrices.c", "sum += share[i]", UNSET,
             "laconic_inertia_shares() writes a share for each wheel of the same vehicle; both loops run to the same "
             "wheel_count"),
    Argument("core_c/src/vector.h", "v[0], v[1], v[2]", UNSET, FILLED, WITH_MODEL),
    Argument("core_c/src/contact.c", "row++", "signed overflow", "at most two rows for each of 16 wheels"),
    Argument("core_c/src/contact.c", "vehicle->support[i - n]", "out of bounds",
             "i runs to n + support_count, and below n the wheel is taken"),
    Argument("core_c/src/friction.c", "vehicle->support[i - n]", "out of bounds",
             "i runs to n + support_count, and below n the wheel is taken"),
    Argument("core_c/src/least_norm.c", "rows[i]", UNSET, "both callers fill `count` rows before"),
    Argument("core_c/src/contact.c", "matrices.", UNSET, FILLED),
    Argument("core_c/src/noise.c", "halvings++", "signed overflow",
             "a word of 64 bits is shifted until its highest bit is set, which is in at most 63 rounds; the caller has "
             "set its lowest"),
    Argument("core_c/src/encoder.c", "const int32_t whole = (int32_t)counts", CONVERSION,
             "counts lies within ±MOST_COUNTS, below 2³¹, by the line before, which NaN does not"),
    Argument("core_c/src/encoder.c", "encoder->count +=", "signed overflow",
             "an encoder begins within ±2⁶² counts (the box), and a step adds less than 2³¹ + 2, so that 2³¹ steps are "
             "needed to leave the range", ("prove_sensors_read", *COUNTED)),
    Argument("core_c/src/integrator.c", "fastest = model->decay_per_s", UNSET, FILLED, OF_PLANT),
    Argument("core_c/src/step_internals.h", "return m->rotated_twice", UNSET, FILLED, OF_PLANT),
    Argument("core_c/src/state.c", "m->dof == 3", UNSET, FILLED, OF_PLANT),
    Argument("core_c/src/vector.h", "v[0], v[1], v[2]", UNSET, FILLED, OF_PLANT),
    Argument("core_c/src/normal_loads.c", "loads->carried_N[i]", UNSET, POINTS, OF_FRICTION),
    Argument("core_c/src/friction_step.c", "p->loads.statics_N[i]", UNSET, POINTS, STEPS_OF_FRICTION),
    Argument("core_c/src/friction.c", "loads.statics_N[i]", UNSET, POINTS,
             ("prove_slip_set", "prove_plant_restart_slipping")),
    Argument("core_c/src/friction_outputs.c", "loads", UNSET, POINTS, OF_FRICTION),
    Argument("core_c/src/friction_outputs.c", "force", UNSET, POINTS, OF_FRICTION),
    Argument("core_c/src/friction_outputs.c", "const real torque = motor.torque", UNSET, POINTS, OF_FRICTION),
    Argument("core_c/src/friction_vehicle.h", "along_across_N[0]", UNSET, POINTS, OF_FRICTION),
    Argument("core_c/src/vector.h", "v[0], v[1], v[2]", UNSET, ROTATES, ("prove_friction_moment",)),
    Argument("core_c/src/vector.h", "v[0], v[1], v[2]", UNSET,
             "laconic_least_norm() fills a row for each of the points, and share() reads as many", STEPS_OF_FRICTION),
    Argument(L, "memcpy(to, ", "valid_dest", PLACE),
    Argument(L, "*(laconic_wheel_kind *)to", "out of bounds", PLACE),
    Argument(L, "vehicle->wheel[item - 1]", "out of bounds",
             "the need of rollers is that of a field with an item for each wheel, whose items begin at 1"),
    Argument("firmware_stub/secure/secoc.c", "*to++", "out of bounds",
             "2 + 64 + 8 bytes are the message's length, and a payload has at most LACONIC_SECOC_LONGEST (the box)"),
    Argument("firmware_stub/secure/cmac.c", "mac[i] ^= bytes[i]", UNSET,
             "code_of() has written number, payload and freshness, which are as many bytes as it states",
             ("prove_secoc", "prove_gate")),
    Argument("core_c/src/friction_solver.c", "c->stiffness[1], c->row[1]", UNSET, RANK),
    Argument("core_c/src/friction_solver.c", "c->gain[1]", UNSET, RANK),
    Argument("core_c/src/vector.h", "factor * v.x", UNSET, RANK, STEPS_OF_FRICTION),
    Argument("core_c/src/vector.h", "a.x * b.x + a.y * b.y + a.z * b.z; }", UNSET, RANK, STEPS_OF_FRICTION),
    Argument("core_c/src/friction_internals.h", "first.x * second", UNSET, RANK),
    Argument("core_c/filter/filter_predict.c", "row[j] += m->nu_of_zeta", UNSET,
             "set to 0 in the first line of the same round"),
    Argument("core_c/filter/filter_predict.c", "* row[j][k]", UNSET,
             "output_row() sets as many numbers as there are errors, in each row up to this one"),
    Argument("core_c/filter/filter_predict.c", "upper[first + i][first + j]", "out of bounds",
             "first is errors − dof and j is below dof, so the sum is below errors, at most 3 + 3 + 1 + 3"),
    Argument("core_c/filter/filter_readings.c", "angle[i]", UNSET, OF_N),
    Argument("core_c/filter/filter_readings.c", "c->found.count++", "signed overflow",
             "begin() sets it to 0, and a reading has at most a number for each wheel"),
    Argument("firmware_stub/src/node_pack.c", "node->answers_due & BIT(offset)", "shift",
             "RESULT is pending only while an answer is due: laconic_node_answer_again() sets both, has_more() and "
             "laconic_node_make_idle() clear both", FRAMES),
    Argument("firmware_stub/src/node.c", "node->pending & BIT(offset)", "shift",
             "pending is not 0, by the line before", FRAMES),
    Argument("firmware_stub/src/node_pack.c", "return (int32_t)(raw < 0", "non-finite",
             "raw lies within ±bound by the same line, which NaN does not", FRAMES),
    Argument("firmware_stub/src/node_control.c", "own_rate_Hz + half", CONVERSION,
             "below 10⁶ by the line before, which NaN is not, and a plant that has started has a positive step",
             FRAMES),
    Argument("firmware_stub/src/node_control.c", "steps + half", CONVERSION,
             "steps lies between a half and LACONIC_NODE_STEPS_PER_TICK + a half by the line before", FRAMES),
    Argument("firmware_stub/src/node_run.c", "1000000U / run->rate_Hz", "division by zero",
             "periods are due only in states that follow laconic_node_begin_periods(), whose rate is at least 1",
             FRAMES),
    Argument("firmware_stub/src/raw_frames.c", "sensed->", UNSET,
             "laconic_node_publish_sensors() fills it where raw_output.send asks for it, which is what is asked here",
             FRAMES),
    Argument("firmware_stub/src/node_pack.c", "node->encoder_wheel", "out of bounds", OF_ENCODER, FRAMES),
    Argument("firmware_stub/src/node_pack.c", "laconic_encoder_turns(encoder, counts)", "precondition", OF_ENCODER,
             FRAMES),
    Argument("firmware_stub/src/node_pack.c", "SCALED(speed[i]", UNSET, OF_N, FRAMES),
    Argument("firmware_stub/src/node_pack.c", "node->wheel_group + k", "out of bounds", GROUP, FRAMES),
    Argument("firmware_stub/src/node_pack.c", "node->angle_group + k", "out of bounds", GROUP, FRAMES),
    Argument("firmware_stub/src/raw_frames.c", "memset(bytes + count", "precondition",
             "count is at most room, by the line before the last", FRAMES),
    Argument("firmware_stub/src/raw_frames.c", "(const uint8_t *)raw->number + raw->position", "precondition",
             "position is at most size, since each call adds at most what is left of it, and size counts numbers that "
             "have been written", FRAMES),
    *(Argument(file, part, UNSET, TAKEN, OF_DERIVATIVES) for file, parts in PLACES_OF_STEPS.items() for part in parts),
)
