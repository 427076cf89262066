"""Scenes: a TOML file → vehicle, start, inputs and run. Every error is one line with file, field and remedy.

    scene = read_scene("scenes/robotino2.toml")
    plant = scene.plant(load(scene.run.real))
    inputs = scene.inputs_on_grid()
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from laconic.base.paths import scene_path
from laconic.core import REALS, Core, load
from laconic.core.articulated import ArticulatedVehicle, max_bodies
from laconic.core.plant import Plant
from laconic.core.sensors import Sensors
from laconic.core.slipping import SlippingVehicle
from laconic.errors import LONGEST_NAME, BadInput, Refused, cut, shown
from laconic.scene.base import BaseTable, FrcTable
from laconic.scene.drives import ArduPilotTable, Drives, SpeedController
from laconic.scene.ground import slips
from laconic.scene.hinges import Hinge, check_without_hinges, refusal_of_hinges
from laconic.scene.inputs import Input, InputsOnGrid, check_resolved, step_remedy
from laconic.scene.keys import in_file
from laconic.scene.methods import METHODS
from laconic.scene.reader import methods_with_hinges, read_parts, read_run
from laconic.scene.sensors import DELAY_S, NO_SENSORS, SensorTables
from laconic.scene.step_choice import AUTO, chosen_step_s
from laconic.scene.table import Table, plain, read_toml

NOUNS = {"body": "bodies on hinges", "wheel": "wheels", "support": "supports"}
MOST_STEPS = 9e15  # as laconic_steps_in
Hinged = TypeVar("Hinged", bound=ArticulatedVehicle)


@dataclass(frozen=True)
class Initial:
    """Where the motion starts: ν, or the velocity of the centre of mass in body axes and the yaw rate."""

    nu_rad_per_s: tuple[float, ...] | None = None
    velocity_body_m_per_s: tuple[float, ...] = (0.0, 0.0)
    yaw_rate_rad_per_s: float = 0.0
    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0
    wheel_speed_rad_per_s: tuple[float, ...] = ()  # as the wheels roll where none is given

    def nu(self, model: Any) -> tuple[float, ...]:
        """ν for a prepared model: v_S = R (ν1, ν2), ν3 = Λ θ'."""
        if self.nu_rad_per_s is not None:
            return self.nu_rad_per_s
        forward, sideways = (v / model.wheel_radius_m for v in self.velocity_body_m_per_s)
        return (forward, sideways, model.yaw_scale * self.yaw_rate_rad_per_s)

    def refusal(self, refused: Refused, model: Any) -> Refused:
        """A start that slides a wheel, by the key that the scene gives: the core names ν."""
        name, scale = f"nu_rad_per_s[{refused.item}]", 1.0
        if self.nu_rad_per_s is None and refused.item < 3:
            name, scale = f"velocity_body_m_per_s[{refused.item}]", model.wheel_radius_m
        elif self.nu_rad_per_s is None:
            name, scale = "yaw_rate_rad_per_s", 1.0 / model.yaw_scale
        value, limit = scale * refused.value, scale * refused.limit
        text = (f"initial.{name}: {value:.6g} (of the centre of mass) makes a fixed or locked wheel slide; the nearest "
                f"value that the wheels allow is {limit:.6g}")
        return Refused(refused.status, refused.field, refused.item, text, value=refused.value, limit=refused.limit)


@dataclass(frozen=True)
class Run:
    """How long, in what steps, by which method, in which scalar type."""

    duration_s: float
    step_s: float
    method: str = "auto"
    real: str = "double"
    tolerance: float | None = None  # by which the step was found; None: it was given


@dataclass(frozen=True)
class Outputs:
    """What to write, and how often; by default the usual signals, every step."""

    signals: tuple[str, ...] = ()
    every_s: float | None = None


@dataclass(frozen=True)
class Rig:
    """What a bus needs to know."""

    id_base: int | None = None
    frames: tuple[str, ...] = ()
    drives: Drives | None = None


@dataclass(frozen=True)
class Scene:
    """One scene; `vehicle` has the keys of `[vehicle]`, with angles in rad and wheels in x and y."""

    path: Path
    name: str
    source: str
    vehicle: dict[str, Any]
    initial: Initial
    inputs: tuple[Input, ...]
    run: Run
    outputs: Outputs = field(default_factory=Outputs)
    rig: Rig = field(default_factory=Rig)
    speed_controller: SpeedController | None = None
    sensors: SensorTables = NO_SENSORS
    base: BaseTable | None = None
    frc: FrcTable | None = None
    ardupilot: ArduPilotTable | None = None
    in_degrees: frozenset[str] = frozenset()  # angles that the file gives so, by their name in rad
    hinges: tuple[Hinge, ...] = ()  # of bodies besides the carriage, in the order of vehicle["body"]
    wheel_places: tuple[str, ...] = ()  # with hinges: the table of each wheel in the file

    @property
    def has_hinges(self) -> bool:
        """Whether bodies hang on hinges: steered wheels, casters, trailers. Few functions take such a scene yet."""
        return bool(self.hinges)

    @property
    def slips_on_hinges(self) -> bool:
        """Whether it has bodies on hinges and wheels that may slip."""
        return self.has_hinges and slips(self.vehicle)

    @property
    def wheel_count(self) -> int:
        """N."""
        return len(self.vehicle["wheel"])

    def with_run(self, *, method: str | None = None, step_s: float | None = None, real: str | None = None,
                 duration_s: float | None = None) -> Scene:
        """The scene with some of `[run]` replaced; what the file could not have there is BadInput as if it had."""
        given: dict[str, Any] = {"method": method, "step_s": step_s, "real": real, "duration_s": duration_s}
        entries = asdict(self.run) | {key: plain(value) for key, value in given.items() if value is not None}
        tolerance = entries.pop("tolerance")
        if tolerance is not None and step_s is None:
            entries |= {"step_s": AUTO, "tolerance": tolerance}
        methods = methods_with_hinges(self.vehicle) if self.has_hinges else METHODS
        run = Run(**read_run(Table(self.path, "run", entries), methods, REALS))
        return with_found_step(replace(self, run=run))

    def with_step(self, step_s: float) -> Scene:
        """The scene in another step, which keeps its tolerance: for those that find the step."""
        return replace(self, run=replace(self.run, step_s=step_s))

    def core(self) -> Core:
        """The core in the scene's scalar type."""
        return load(self.run.real)

    def c_vehicle(self, core: Core) -> Any:
        """The checked laconic_vehicle, its motor fitted; BadInput for a scene with hinges."""
        check_without_hinges(self, "this")
        for what, limit in (("wheel", core.max_wheels), ("support", core.max_supports)):
            if len(self.vehicle[what]) > limit:
                raise BadInput(f"{self.path}: vehicle.{what}: {len(self.vehicle[what])} of them, this build of the "
                               f"core has room for {limit}; take some out")
        try:
            vehicle = core.vehicle(self.vehicle)
            core.check_vehicle(vehicle)
            return vehicle
        except Refused as refused:
            raise self.refusal_in_file(refused) from None

    def model(self, core: Core) -> Any:
        """The prepared laconic_model."""
        vehicle = self.c_vehicle(core)
        try:
            return core.prepare(vehicle)
        except Refused as refused:
            raise self.refusal_in_file(refused) from None

    def c_start(self, core: Core) -> Any:
        """The laconic_start."""
        start = {field.key: getattr(self.initial, field.key) for field in core.fields_of("initial")}
        return core.ffi.new("laconic_start *", start | {"nu_rad_per_s": self.initial.nu(self.model(core))})

    def plant(self, core: Core) -> Plant:
        """The vehicle at its start, ready to step by the scene's method and step."""
        start, model = self.initial, self.model(core)
        nu, vehicle = start.nu(model), self.c_vehicle(core)
        try:
            return core.plant(vehicle, self.run.method, self.run.step_s, nu_rad_per_s=nu, x_m=start.x_m,
                              y_m=start.y_m, heading_rad=start.heading_rad,
                              wheel_speed_rad_per_s=start.wheel_speed_rad_per_s)
        except Refused as refused:
            if refused.status == "start against constraints":
                raise start.refusal(refused, model).at(self.path) from None
            raise self.refusal_in_file(refused) from None

    def articulated_vehicle(self, core: Core) -> ArticulatedVehicle:
        """The checked vehicle of a scene with hinges on ideal ground."""
        if self.slips_on_hinges:
            raise BadInput(f"{self.path}: ground.friction_coefficient: this does not take hinges on ground with "
                           "friction yet; use laconic simulate, fmu, rig or play, or take it out")
        return self._with_room(core, ArticulatedVehicle)

    def slipping_vehicle(self, core: Core) -> SlippingVehicle:
        """The checked vehicle of a scene with hinges on ground with friction."""
        return self._with_room(core, SlippingVehicle)

    def _with_room(self, core: Core, kind: type[Hinged]) -> Hinged:
        limits = (("body", max_bodies(core)), ("wheel", core.max_wheels), ("support", core.max_supports))
        for what, limit in limits:
            if len(self.vehicle[what]) > limit:
                raise BadInput(f"{self.path}: vehicle: has {len(self.vehicle[what])} {NOUNS[what]}, this build of the "
                               f"core has room for {limit}; take some out")
        try:
            return kind(self.vehicle, core.real)
        except Refused as refused:
            raise self.refusal_in_file(refused) from None
        except BadInput as bad:
            raise BadInput(f"{self.path}: {bad}") from None

    def delay_steps(self, core: Core) -> int:
        """The IMU's delay in steps of the scene."""
        delay_s = (self.sensors.imu or {}).get(DELAY_S, 0.0)
        steps = self.steps_in(f"sensors.imu.{DELAY_S}", delay_s) if delay_s else 0
        if steps > core.most_delay_steps:
            raise BadInput(f"{self.path}: sensors.imu.{DELAY_S}: {delay_s:g} s are {steps} steps of "
                           f"{self.run.step_s:g} s; give at most {core.most_delay_steps} steps, or a longer step")
        return steps

    def sensors_of(self, plant: Plant) -> Sensors:
        """The scene's sensors as after power-up, beside a plant of it; what the scene does not give is ideal."""
        settings = self.sensors.settings(self.delay_steps(plant.core))
        try:
            return plant.sensors(settings)
        except Refused as refused:
            raise self.refusal_in_file(refused) from None

    def refusal_in_file(self, refused: Refused, when: str = "") -> Refused:
        """A refusal of the core with this file in front, by the names that the file has."""
        if refused.status == "overflow" and not refused.field:
            refused = refused.at("vehicle")  # of its numbers together
        if self.has_hinges:
            refused = refusal_of_hinges(refused, self.hinges, self.wheel_places, self.slips_on_hinges)
        return in_file(refused, self.in_degrees).at(f"{self.path}: {when}" if when else self.path)

    def steps(self) -> int:
        """The run's whole number of steps."""
        return self.steps_in("run.duration_s", self.run.duration_s)

    def steps_in(self, name: str, interval_s: float) -> int:
        """The whole number of steps in an interval of this scene; BadInput names the field when there is none."""
        if interval_s / self.run.step_s >= MOST_STEPS:
            raise BadInput(f"{self.path}: {name}: {interval_s:g} s are more steps of {self.run.step_s:g} s than can be "
                           "counted; give a shorter time or a longer step")
        try:
            return load("double").steps_in(interval_s, self.run.step_s)
        except Refused as refused:
            if refused.status != "step does not fit":
                raise refused.at(f"{self.path}: {name}") from None
            remedy = step_remedy(self.instants(), self.run.step_s)
            raise BadInput(f"{self.path}: {name}: {interval_s:g} s is no whole number of steps of "
                           f"{self.run.step_s:g} s; {remedy}") from None

    def instants(self) -> list[float]:
        """Every instant of the run that must fall on a step."""
        changes = [t for each in self.inputs if each.kind == "steps" for t in each.t_s if t < self.run.duration_s]
        given = (self.outputs.every_s, (self.sensors.imu or {}).get(DELAY_S))
        return [self.run.duration_s, *(each for each in given if each), *changes]

    def inputs_on_grid(self) -> InputsOnGrid:
        """The inputs on the grid of the scene's steps."""
        steps, instants = self.steps(), self.instants()
        check_resolved(self.path, self.inputs, self.run.step_s, instants)
        return InputsOnGrid.on_grid(self.path, self.inputs, self.run.step_s, steps, instants)


def check_scene(given: Any) -> Scene:
    """A scene as it is; BadInput for a path, a name or anything else."""
    if not isinstance(given, Scene):
        raise BadInput(f"scene: {shown(given)} is no Scene; give read_scene(path or name)")
    return given


def read_scene(given: str | Path) -> Scene:
    """Reads a scene by its path, or by the name of one that comes with the project."""
    return scene_of(read_toml(scene_path(given)))


def scene_of(top: Table) -> Scene:
    """The scene in a file's top table."""
    parts = read_parts(top, methods=METHODS, reals=REALS)
    return with_found_step(Scene(
        path=top.path, name=parts["name"], source=parts["source"], vehicle=parts["vehicle"],
        initial=Initial(**parts["initial"]), inputs=tuple(parts["inputs"]), run=Run(**parts["run"]),
        outputs=Outputs(**parts["outputs"]), rig=Rig(**parts["rig"]), speed_controller=parts["speed_controller"],
        sensors=parts["sensors"], base=parts["base"], frc=parts["frc"], ardupilot=parts["ardupilot"],
        in_degrees=parts["in_degrees"], hinges=parts["hinges"], wheel_places=parts["wheel_places"]))


def with_found_step(scene: Scene) -> Scene:
    """The scene itself, or where its step is "auto" with the step that keeps its tolerance."""
    tolerance = scene.run.tolerance
    return scene if tolerance is None else scene.with_step(chosen_step_s(scene, tolerance))


# ---- A scene from tables in a program instead of a file.

def build_scene(tables: Mapping[str, Any]) -> Scene:
    """A scene from the tables that a scene file has (docs/scenes.md), as mappings and lists.

    `tables` needs "vehicle" and "run"; "name", "ground", "initial", "input", "outputs" … are as in a file, angles in
    rad or with `_deg` at the key's end; arrays stand for lists. Raises BadInput as `read_scene` does: it names the key.
    """
    if not isinstance(tables, Mapping):
        raise BadInput(f"scene: {shown(tables)} is no mapping; give the tables of a scene, such as {{\"vehicle\": …}}")
    given = tables.get("name")
    name = given[:LONGEST_NAME] if isinstance(given, str) and given else "scene"
    try:
        values = _values(tables)
    except RecursionError:
        raise BadInput(f"{cut(name)}: nests its tables too deeply, or one in itself; give those of a scene"
                       ) from None
    return scene_of(Table(Path(name.replace("/", "-")), "", values))


def _values(given: Any) -> Any:
    """What a TOML file could hold of it: dicts, lists, numbers, texts."""
    if isinstance(given, Mapping):
        return {str(key): _values(value) for key, value in given.items()}
    if isinstance(given, np.ndarray):
        return _values(given.tolist())
    if isinstance(given, list | tuple):
        return [_values(value) for value in given]
    return plain(given)
