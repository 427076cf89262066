"""Alarms of the analyser that cannot happen, each with its argument: file, part of the source line, part of the "
"alarm."""

from __future__ import annotations

E, H, M = "core_c/src/elementary.c", "core_c/src/heading.h", "core_c/src/message.c"
CONVERSION, UNSET = "", "uninitialized"
OF_N = "written for each wheel of the same model in the lines before; both loops run to the same wheel_count"
ROTATES = ("cosine and sine of a forcing, and what is made of them, are read only where its flag `rotates` is "
           "set; the function that sets the flag sets them, too. The analyser forgets that both go together")

DISCHARGED: tuple[tuple[str, str, str, str], ...] = (
    ("core_c/proof/core.c", "assert 0 <= vehicle.wheel_count", "assertion",
     "the second test of laconic_vehicle_check() refuses every other count; the analyser merges its returns"),
    ("core_c/proof/core.c", "assert 0 <= vehicle.support_count", "assertion",
     "the first test of check_supports(), by which laconic_vehicle_check() goes, refuses every other count"),
    (E, "(int32_t)(quarters", CONVERSION,
     "quarters lies within ±10⁶ by the line before, by the function magnitude(); NaN and larger ones take the "
     "other way"),
    (E, "(int)(a * R(1.4426950408889634)", "non-finite",
     "a < EXPONENT_SPAN in the line before, which NaN is not; a is h·r, and rates of a model are not negative"),
    (E, "(real)(signed_binary_angle)turns", CONVERSION,
     "turns lies within ±2⁶³ (single: 2³¹) by the line before, by the function magnitude(); NaN takes the other way"),
    (E, "(signed_binary_angle)(part * HALF_TURN)", CONVERSION,
     "part is a number less its whole part, so within ±(1 − 2⁻⁵³), and the product is at most 2⁶³ − 2¹⁰"),
    (H, "const signed_binary_angle whole", CONVERSION,
     "both callers have refused yaw that is not below LARGEST_YAW_CHANGE_RAD, 2⁶⁴ rad, NaN included: 2.9·10¹⁸ "
     "turns, below 2⁶³"),
    (H, "const signed_binary_angle half", CONVERSION,
     "turns − whole lies in (−1, 1), so its product with 2⁶³ is at most 2⁶³ − 2¹⁰; rest is within ±1 in every "
     "heading that the core has made, since it is what rounding to whole units left"),
    (H, "heading->turns += whole", "signed overflow",
     "whole is within ±2.9·10¹⁸; steps begin within 2⁶² turns (heading_has_room) and a start with none, so the "
     "sum stays within 7.6·10¹⁸"),
    ("core_c/src/integrator.c", "step = why.limit", UNSET,
     "laconic_integrator_prepare() has refused, and each of its refusals fills the struct it is given"),
    ("core_c/src/integrator.c", "(uint64_t)(ratio + 0.5)", "non-finite",
     "ratio is positive, since interval and step are, and below 9·10¹⁵ by the line before, which NaN is not"),
    (M, "w->text[w->length] = c", "out of bounds",
     "length + 1 < size in the same line, and the text has room for size"),
    (M, "exponent++", "signed overflow", "a finite number is divided by 10 at most 308 times"),
    (M, "exponent--", "signed overflow", "a number above 0 is multiplied by 10 at most 324 times"),
    (M, "-exponent : exponent", "signed overflow", "the exponent is within ±324"),
    (M, "for (c = explanation(why->status)", "out of bounds", "explanations end with 0, where the loop ends"),
    (M, "for (; *path != '\\0'; path++)", "out of bounds",
     "paths end with 0; past '[' two more letters are skipped, and every '[' of a path begins \"[#]\""),
    ("core_c/src/outputs.c", "angle_rad[i]", UNSET, OF_N),
    ("core_c/src/outputs.c", "torque_Nm[i] = model->motor_gain_Nm_per_V", UNSET, OF_N),
    ("core_c/src/state.c", "zero_if_finite(angle[i])", UNSET, OF_N),
    ("core_c/src/contact.c", "torque_Nm[i]", UNSET, OF_N),
    ("core_c/src/prepare.c", "row[k]", UNSET,
     "laconic_constraint_rows() fills as many rows as it returns, and only these are read"),
    ("core_c/src/taylor_8.c", "heading_sine", UNSET, ROTATES),
    ("core_c/src/taylor_8.c", "heading_cosine", UNSET, ROTATES),
    ("core_c/src/vector.h", "v[0], v[1], v[2]", UNSET, ROTATES),
    ("core_c/src/vector.h", "a.x + b.x", UNSET, ROTATES),
    ("core_c/src/vector.h", "v.x", UNSET, ROTATES),
    ("firmware_stub/src/raw_frames.c", "raw->position / each", "division by zero",
     "laconic_raw_take() has refused where no number is chosen, by the same function of the same arguments"),
    ("firmware_stub/src/raw_frames.c", "memcpy(to, raw->number", "precondition",
     "position < 3·each while not complete, so position / each ≤ 2 and a slot is found for position modulo each"),
    ("firmware_stub/src/raw_frames.c", "raw->number[raw->filled++]", "out of bounds",
     "filled becomes 0 in store() as soon as it reaches the size of a number"),
    ("firmware_stub/src/slcan.c", "*to++", "out of bounds",
     "1 + 8 + 1 + 2·64 + 1 letters are the line's length; a frame has at most LACONIC_FRAME_BYTES bytes (the box)"),
    ("firmware_stub/src/slcan.c", "(size_t)(to - text)", "signed overflow", "at most LACONIC_SLCAN_LINE letters"),
    ("firmware_stub/src/protection.c", "list_of(offset)[", "out of bounds",
     "a list has sixteen entries, and the index is masked to sixteen; only frames of CAN FD, which do not come "
     "here, have no list"),
)
