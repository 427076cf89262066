"""The core for one scene, as C: constants by which the compiler removes the rest, and a prepared model.

    files = trimmed(read_scene("s1"), "single")
    files.header    laconic_scene.h: LACONIC_SCENE_HEADER of real.h
    files.table_h   laconic_scene_model.h, files.table_c: model, integrator and start as constants

Of a vehicle with hinges these are those of articulated.h.

The model is prepared here, so that flash contains neither preparation nor checks; the target would compute the same
numbers, because every platform gives the same bits.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.outputs import write_text
from laconic.core import Core, load
from laconic.core.plant import Plant
from laconic.scene import Scene
from laconic.scene.ground import check_rolling
from laconic.scene.methods import ROWS

OF_EACH_WHEEL = ("voltage_scale", "motor_gain_Nm_per_V", "motor_damping_Nms", "wheel_inertia_kgm2")
"""Members of laconic_model that have one item where all wheels are alike."""
FRICTION = "friction"  # the method that a plant with friction chooses
NEED_OF = {row.name: row.needs for row in ROWS}  # what a method needs of a build: the end of LACONIC_WITH_…
POSE = ("x_m", "y_m", "heading_rad", "heading_wrapped_rad", "origin_x_m", "origin_y_m")


@dataclass(frozen=True)
class Needs:
    """Inputs that the scene uses and quantities that it computes: LACONIC_WITH_… of real.h."""

    voltage: bool
    axle_torque: bool
    body_wrench: bool
    world_force: bool
    sampled_input: bool
    pose: bool
    wheel_angles: bool
    damping: bool
    own_wheels: bool  # some wheel has values of its own
    slope: bool
    friction: bool  # stepped by laconic_friction_step: wheels slip, or motors have limits


@dataclass(frozen=True)
class HingeNeeds:
    """The same of a vehicle with hinges, whose inputs are all there."""

    damping: bool
    wheel_angles: bool
    slope: bool
    friction: bool = False


@dataclass(frozen=True)
class Trimmed:
    """The generated files of one scene and scalar type."""

    needs: Needs | HingeNeeds
    method: str
    method_steps: tuple[str, ...]  # the core's functions that a step may reach through the method's pointer
    header: str
    table_h: str
    table_c: str

    def write(self, folder: Path) -> None:
        """Writes those files that have changed, so that unchanged files are not compiled again."""
        names = {"laconic_scene.h": self.header, "laconic_scene_model.h": self.table_h,
                 "laconic_scene_model.c": self.table_c}
        for name, text in names.items():
            path = folder / name
            if not holds(path, text):
                write_text(path, text)


def holds(path: Path, text: str) -> bool:
    """Whether the file exists and has exactly this text."""
    try:
        return path.read_text(encoding="utf-8") == text
    except (OSError, UnicodeDecodeError):
        return False


def needs_of(scene: Scene) -> Needs:
    """Read from the scene's inputs and outputs; without `[outputs] signals`, pose and wheel angles are computed."""
    acting = {each.signal.partition("[")[0] for each in scene.inputs}
    wanted = {name.partition("[")[0] for name in scene.outputs.signals}
    plant = scene.plant(load("double"))
    slope = bool(plant.c.model.sloped)
    world_force = slope or "world_force_N" in acting  # either turns with the heading
    return Needs(
        voltage="voltage_V" in acting, axle_torque="axle_torque_Nm" in acting,
        body_wrench=bool(acting & {"body_force_N", "body_moment_Nm"}), world_force=world_force,
        sampled_input=not scene.inputs_on_grid().is_held,
        pose=world_force or not wanted or not wanted.isdisjoint(POSE),
        wheel_angles=scene.wheel_count > 0 and (not wanted or "wheel_angle_rad" in wanted),
        damping=any(plant.c.model.decay_per_s),
        own_wheels=any(wheel.undriven or any(getattr(wheel, field.member) for field in plant.core.own_fields())
                       for wheel in plant.c.vehicle.wheel),
        slope=slope, friction=plant.has_friction)


def trimmed(scene: Scene, real: str) -> Trimmed:
    """Everything a build for this scene alone consists of."""
    if scene.has_hinges:
        return trimmed_with_hinges(scene, real)
    core = load(real)
    plant = scene.plant(core)
    method = plant.chosen_method
    needs = needs_of(scene)
    steps = method_steps(scene, method, bool(plant.c.integrator.stiff))
    return Trimmed(needs, method, steps, header_of(scene, real, needs, method),
                   table_header(scene, real, needs), tables(core, plant, scene))


def method_steps(scene: Scene, chosen: str, stiff: bool) -> tuple[str, ...]:
    """The method's own step function; for auto its own and those of the methods that it calls; none with friction,
    whose step calls nothing by a pointer."""
    if chosen == FRICTION:
        return ()
    own = f"{chosen.replace('-', '_')}_step"
    if scene.run.method != "auto":
        return (own,)
    if stiff:
        return ("auto_fast_step", own, "exponential_kahan_4_step", "exact_flow_step")
    return ("auto_slow_step", own, "exact_flow_4_step", "exact_flow_step")


def header_of(scene: Scene, real: str, needs: Needs, method: str) -> str:
    """laconic_scene.h."""
    n, supports = scene.wheel_count, max(1, len(scene.vehicle["support"]) if needs.friction else 0)
    lines = [f"/* {scene.path.name}: what this build of the core is for ({real}). Generated. */",
             "#ifndef LACONIC_SCENE_H", "#define LACONIC_SCENE_H", *real_check(scene, real),
             f"#define LACONIC_MAX_WHEELS {max(1, n)}", f"#define LACONIC_MAX_SUPPORTS {supports}",
             "#define LACONIC_MAX_BODIES 0", f"#define LACONIC_WHEELS(model) ((void)(model), {n})",
             "#define LACONIC_WITH_PREPARE 0"]
    lines += [f"#define LACONIC_WITH_{name.upper()} {int(value)}" for name, value in asdict(needs).items()]
    lines += [f"#define LACONIC_WITH_{need} {int(NEED_OF.get(method) == need)}"
              for need in sorted(set(NEED_OF.values()) - {"NOTHING"})]
    return "\n".join([*lines, "#endif", ""])


def real_check(scene: Scene, real: str) -> list[str]:
    """Lines that refuse the other scalar type, whose structs are of another size."""
    other, hint = ("#ifdef", "without") if real == "double" else ("#ifndef", "with")
    return [f"{other} LACONIC_SINGLE",
            f'#error "laconic: {scene.path.name} was prepared for {real}: compile {hint} LACONIC_SINGLE"', "#endif"]


def table_header(scene: Scene, real: str, needs: Needs) -> str:
    """laconic_scene_model.h."""
    declared = ("extern const laconic_model laconic_scene_model;",
                "extern const laconic_integrator laconic_scene_integrator;",
                "extern const laconic_state laconic_scene_start;", *(FRICTION_TABLES if needs.friction else ()))
    return _table_header(scene, real, FRICTION_STEPS if needs.friction else STEPS, declared)


def _table_header(scene: Scene, real: str, steps: Sequence[str], declared: Sequence[str],
                  includes: Sequence[str] = ()) -> str:
    single = "-DLACONIC_SINGLE " if real == "single" else ""
    return "\n".join([
        f"/* {scene.path.name}, prepared: step it with", *steps,
        " * The structs are those of the library: what links the trimmed one is compiled like it, with",
        f" *     {single}-DLACONIC_SCENE_HEADER='\"laconic_scene.h\"'",
        " * Generated. */",
        "#ifndef LACONIC_SCENE_MODEL_H", "#define LACONIC_SCENE_MODEL_H", "", *real_check(scene, real), "",
        '#include "laconic/laconic.h"', *includes, "", *declared, "", "#endif", ""])


STEPS = (
    " *     laconic_state state = laconic_scene_start;",
    " *     laconic_step(&laconic_scene_model, &laconic_scene_integrator, &state, &input);")
FRICTION_STEPS = (
    " *     laconic_state state = laconic_scene_start;",
    " *     laconic_slip slip = laconic_scene_slip;",
    " *     laconic_friction_step(&laconic_scene_friction, &laconic_scene_model, laconic_scene_integrator.step_s,",
    " *                           &state, &slip, &input);",
    " * An input that varies within the step is taken in its middle.")
FRICTION_TABLES = (
    "", "#define LACONIC_SCENE_SLIPS", "extern const laconic_friction laconic_scene_friction;",
    "extern const laconic_slip laconic_scene_slip;")


# ------------------------------------------------------------------------------- vehicles with hinges

HINGE_INCLUDES = (
    "#ifndef LACONIC_ARTICULATED_H /* laconic.h of the two files has it */", '#include "laconic/articulated.h"',
    "#endif")
HINGE_STEPS = (
    " *     laconic_articulated_state state = laconic_scene_start;",
    " *     laconic_articulated_ramp(&from, &to, laconic_scene_integrator.step_s);",
    " *     laconic_articulated_step(&laconic_scene_model, &laconic_scene_integrator, &state, &from, &to, NULL);",
    " * Coordinated and prescribed hinges start as the scene's inputs command them at 0 s.")


def trimmed_with_hinges(scene: Scene, real: str) -> Trimmed:
    """The files of a vehicle with hinges, for core_c/src and core_c/optional/articulated."""
    from laconic.simulation.articulated import start_plant
    from laconic.simulation.steering import Commands

    check_rolling(scene, "trim of a vehicle with hinges")
    scene, core = scene.with_run(real=real), load(real)
    vehicle = scene.articulated_vehicle(core)
    plant = start_plant(scene, vehicle, Commands(scene, vehicle, scene.inputs_on_grid()).first_row())
    model, wanted = vehicle.model, {name.partition("[")[0] for name in scene.outputs.signals}
    needs = HingeNeeds(any(model.decay_per_s) or any(link.drags for link in model.link),
                       not wanted or "wheel_angle_rad" in wanted,
                       bool(model.slope_acceleration.x or model.slope_acceleration.y))
    lines = [f"/* {scene.path.name}: what this build of the core is for ({real}). Generated. */",
             "#ifndef LACONIC_SCENE_H", "#define LACONIC_SCENE_H", *real_check(scene, real),
             f"#define LACONIC_MAX_WHEELS {max(1, scene.wheel_count)}", "#define LACONIC_MAX_SUPPORTS 1",
             f"#define LACONIC_MAX_BODIES {vehicle.body_count}", "#define LACONIC_WITH_PREPARE 0"]
    lines += [f"#define LACONIC_WITH_{name.upper()} {int(value)}" for name, value in asdict(needs).items()]
    values = {"model": model[0], "integrator": plant.integrator[0], "start": plant.c[0]}
    kinds = {"model": "model", "integrator": "integrator", "start": "state"}
    table = [f"/* {scene.path.name}, prepared. Generated. */", '#include "laconic_scene_model.h"', ""]
    table += [f"const laconic_articulated_{kinds[name]} laconic_scene_{name} = {initializer(core.ffi, value, {})};"
              for name, value in values.items()]
    return Trimmed(needs, plant.method, (), "\n".join([*lines, "#endif", ""]),
                   _table_header(scene, real, HINGE_STEPS, tuple(
                       f"extern const laconic_articulated_{kinds[name]} laconic_scene_{name};" for name in values),
                       HINGE_INCLUDES),
                   "\n".join([*table, ""]))


EACH_WHEEL = (
    "", "/* A value of each wheel; a build for wheels that are alike has room for the first one's. */",
    "#if LACONIC_WITH_OWN_WHEELS", "#define EACH_WHEEL(first, ...) {first, __VA_ARGS__}", "#else",
    "#define EACH_WHEEL(first, ...) {first}", "#endif")


def for_each_wheel(text: str) -> str:
    """The model's initializer with EACH_WHEEL, so that it fits the trimmed build and the whole one."""
    members = "|".join(OF_EACH_WHEEL)
    return re.sub(rf"\.({members}) = {{(\[0\] = [^,}}]+), ([^}}]+)}}", r".\1 = EACH_WHEEL(\2, \3)", text)


def tables(core: Core, plant: Plant, scene: Scene) -> str:
    """laconic_scene_model.c: the plant's constants and start, to the last bit."""
    integrator = core.ffi.new("laconic_integrator *", plant.c.integrator)
    integrator.method = integrator.chosen
    if plant.has_friction:  # whose step reads the length of a step alone
        integrator = core.ffi.new("laconic_integrator *", {"step_s": plant.c.integrator.step_s})
    names = {} if plant.has_friction else method_symbols(core, integrator)
    values: dict[str, tuple[str, Any]] = {
        "laconic_scene_model": ("laconic_model", plant.c.model),
        "laconic_scene_integrator": ("laconic_integrator", integrator[0]),
        "laconic_scene_start": ("laconic_state", plant.c.state)}
    if plant.has_friction:
        values |= {"laconic_scene_friction": ("laconic_friction", plant.c.friction),
                   "laconic_scene_slip": ("laconic_slip", plant.c.slip)}
    lines = [f"/* {scene.path.name}, prepared. Generated. */", '#include "laconic_scene_model.h"', *EACH_WHEEL, ""]
    lines += [f"const {kind} {name} = {for_each_wheel(initializer(core.ffi, value, names))};"
              for name, (kind, value) in values.items()]
    return "\n".join([*lines, ""])


def method_symbols(core: Core, integrator: Any) -> dict[int, str]:
    """Address of a method → its C name. What auto chose is a row of methods with a name of its own."""
    found = {_address(core, core.method(name)): f"&laconic_{name.replace('-', '_')}" for name in core.method_names}
    found.setdefault(_address(core, integrator.chosen), f"&laconic_auto_{'fast' if integrator.stiff else 'slow'}")
    return found


def _address(core: Core, pointer: Any) -> int:
    return int(core.ffi.cast("uintptr_t", pointer))


# ---- C tables from the core's own structs: a prepared model as constant data, so that flash holds no preparation.

def c_literal(value: float, single: bool) -> str:
    """A C literal that is compiled to the same bits."""
    if not math.isfinite(value):
        raise ValueError(f"a table cannot hold {value}")
    text = str(np.float32(value)) if single else repr(float(value))
    if "." not in text and "e" not in text:
        text += ".0"
    return text + ("F" if single else "")


def initializer(ffi: Any, value: Any, names: dict[int, str]) -> str:
    """A C initializer for a struct, array or number; zeros are left out, pointers become the names in `names`.

    Without zeros a table also fits a build whose arrays are shorter (LACONIC_MAX_WHEELS).
    """
    kind = ffi.typeof(value) if isinstance(value, ffi.CData) else None
    if kind is None:
        raise TypeError(f"no C value: {value!r}")
    if kind.kind == "struct":
        parts = [(f".{name}", _member(ffi, value, name, field.type, names)) for name, field in kind.fields]
    elif kind.kind == "array":
        parts = [(f"[{i}]", _element(ffi, value, i, kind.item, names)) for i in range(kind.length)]
    elif kind.kind == "pointer":
        return names[int(ffi.cast("uintptr_t", value))]
    else:
        raise TypeError(f"cannot write {kind.cname}")
    return "{" + (", ".join(f"{designator} = {text}" for designator, text in parts if text) or "0") + "}"


def _member(ffi: Any, struct: Any, name: str, kind: Any, names: dict[int, str]) -> str:
    return _text(ffi, getattr(struct, name), kind, names)


def _element(ffi: Any, array: Any, index: int, kind: Any, names: dict[int, str]) -> str:
    return _text(ffi, array[index], kind, names)


def _text(ffi: Any, value: Any, kind: Any, names: dict[int, str]) -> str:
    """The value as text, empty where it is zero."""
    if kind.kind in ("struct", "array"):
        text = initializer(ffi, value, names)
        return "" if text == "{0}" else text
    if kind.kind == "pointer":
        return names[int(ffi.cast("uintptr_t", value))] if value else ""
    if kind.cname in ("float", "double"):
        return "" if value == 0 and math.copysign(1, value) > 0 else c_literal(value, kind.cname == "float")
    if kind.kind == "enum":
        value = int(ffi.cast("int", value)) if isinstance(value, ffi.CData) else value
    number = int(value)
    suffix = "ULL" if number > 0x7FFFFFFF else ""
    return f"{number}{suffix}" if number else ""
