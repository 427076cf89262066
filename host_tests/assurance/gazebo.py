"""Gazebo's physics (ign-physics 5 with DART) and this core on the same robots: error against step, and time of a step.

    python host_tests/assurance/run.py gazebo

Needs Debian's libignition-physics-dev (which brings the plugin of DART), g++ and pkg-config; without them it prints one
line. The SDF file is made from the scene, and both follow the scene's inputs to its end. The reference is the core with
a step of 0.1 ms. In Gazebo, wheels are spheres, which touch the ground in one point as wheels here do. Supports are
balls without friction, one more in front: a robot whose mass is above its axle would tip over. Motors' damping is
explicit, as in a controller; steered hinges follow the angles that this core has.

The robot that slips shows how the two differ on ground with friction. `with_limits_of_dart` is a third program: laws of
this core, but the limit of each wheel's friction is that of the load which it would carry without friction.
"""

from __future__ import annotations

import argparse
import math
import shutil
import signal
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from assurance.common import Unusable
from laconic.base.paths import build_dir
from laconic.core.articulated import ArticulatedVehicle
from laconic.scene import Scene, read_scene
from laconic.simulation import simulate

SOURCE = Path(__file__).with_name("gazebo.cc")
PACKAGES = ("ignition-physics5", "ignition-physics5-sdf", "ignition-plugin1-loader", "sdformat12")
STEPS_S = (0.002, 0.001, 0.0005, 0.00025)
OURS_S, REFERENCE_S, THIRD_S = (0.005, 0.001), 1e-4, 2.5e-4
GRAVITY = 9.81
LIGHTEST_SHARE = 0.05  # of its body is a wheel at most, whose mass no scene gives
SLIPS, OWN_LOADS = "mecanum that slips", "the same, by DART's limits"
SCENES = {"differential": "turtlebot3_burger", "mecanum": "kuka_youbot", "four casters": "mir_like",
          "Ackermann": "f1tenth"}
SLIPPING = """
name = "mecanum robot that slips when its motors are reversed"
[vehicle]
mass_kg = 10.0
yaw_inertia_kgm2 = 0.2766
com_z_m = 0.05
wheel_radius_m = 0.05
wheel_inertia_kgm2 = 0.000625
motor_gain_Nm_per_V = 0.15
motor_damping_Nms = 0.05
wheel = [
    {kind = "mecanum", x_m = 0.2, y_m = 0.15, axle_deg = -90.0, roller_deg = 45.0},
    {kind = "mecanum", x_m = -0.2, y_m = 0.15, axle_deg = -90.0, roller_deg = -45.0},
    {kind = "mecanum", x_m = 0.2, y_m = -0.15, axle_deg = -90.0, roller_deg = -45.0},
    {kind = "mecanum", x_m = -0.2, y_m = -0.15, axle_deg = -90.0, roller_deg = 45.0},
]
[ground]
friction_coefficient = 0.8
[run]
duration_s = 4.0
step_s = 0.001
""" + "".join(f'[[input]]\nsignal = "voltage_V[{i}]"\nkind = "steps"\nt_s = [0.0, 2.0]\nvalue = [{a}, {b}]\n'
              for i, (a, b) in enumerate(((3.0, 4.0), (-3.0, 2.0), (-3.0, 3.0), (3.0, 1.0)), 1))
Pose = tuple[float, float, float]


@dataclass(frozen=True)
class Part:
    """A mass, where it is in the plane, and its inertia about the vertical there."""

    mass_kg: float
    x_m: float
    y_m: float
    inertia_kgm2: float

    def without(self, parts: Sequence[Part]) -> Part:
        """What remains of it."""
        mass_kg = self.mass_kg - sum(each.mass_kg for each in parts)
        x_m = (self.mass_kg * self.x_m - sum(each.mass_kg * each.x_m for each in parts)) / mass_kg
        y_m = (self.mass_kg * self.y_m - sum(each.mass_kg * each.y_m for each in parts)) / mass_kg
        rest = Part(mass_kg, x_m, y_m, 0.0)
        return replace(rest, inertia_kgm2=self.inertia_kgm2 - sum(
            each.inertia_kgm2 + each.mass_kg * math.hypot(each.x_m - self.x_m, each.y_m - self.y_m)**2
            for each in (*parts, rest)))


@dataclass(frozen=True)
class Wheel:
    """A wheel of a robot: its frame is that of its body."""

    body: str
    mass: Part
    spin_kgm2: float
    radius_m: float
    axle_rad: float
    roller_rad: float | None
    motor: tuple[float, float] | None
    """Torque of a volt, and damping."""


@dataclass(frozen=True)
class Robot:
    """A scene, and its numbers as both programs have them."""

    scene: Scene
    body: dict[str, Part]
    wheels: tuple[Wheel, ...]
    friction: float

    @property
    def hinges(self) -> list[dict[str, Any]]:
        """The bodies on hinges."""
        return list(self.scene.vehicle.get("body", ()))

    @property
    def steered(self) -> list[str]:
        """Bodies whose angle is prescribed."""
        return [each["name"] for each in self.hinges if each["hinge"] != "free"]

    @property
    def driven(self) -> list[int]:
        """Wheels with a motor."""
        return [at for at, wheel in enumerate(self.wheels) if wheel.motor]


def robot_of(scene: Scene) -> Robot:
    """The numbers of a scene. Bodies without mass get one that the carriage gives: Gazebo has no massless links."""
    scene = replace(scene, vehicle=_with_masses(scene.vehicle))
    table, core = scene.vehicle, scene.core()
    base = ArticulatedVehicle(table).c.base if scene.has_hinges else scene.c_vehicle(core)[0]
    body = {"carriage": _carriage(table)} | {each["name"]: Part(
        each["mass_kg"], each.get("com_x_m", 0.0), each.get("com_y_m", 0.0), each["yaw_inertia_kgm2"])
        for each in table.get("body", ())}
    wheels = []
    for at, given in enumerate(table["wheel"]):
        wheel, of = base.wheel[at], given.get("body", "carriage")
        radius_m = wheel.own_radius_m or base.wheel_radius_m
        spin_kgm2 = wheel.own_inertia_kgm2 or base.wheel_inertia_kgm2
        mass_kg = min(2 * spin_kgm2 / radius_m**2, LIGHTEST_SHARE * body[of].mass_kg)
        wheels.append(Wheel(of, Part(mass_kg, wheel.x_m, wheel.y_m, 0.51 * spin_kgm2), spin_kgm2, radius_m,
                            wheel.axle_rad, wheel.roller_rad if given["kind"] == "mecanum" else None,
                            None if wheel.undriven else (base.motor_gain_Nm_per_V, base.motor_damping_Nms)))
    ground = table.get("ground", {}).get("friction_coefficient", table["friction_coefficient"])
    return Robot(scene, body, tuple(wheels), ground)


def _carriage(table: dict[str, Any]) -> Part:
    return Part(table["mass_kg"], table["com_x_m"], table["com_y_m"], table["yaw_inertia_kgm2"])


def _with_masses(table: dict[str, Any]) -> dict[str, Any]:
    bodies, taken = [], []
    for each in table.get("body", ()):
        if each["mass_kg"]:
            bodies.append(each)
            continue
        inertia = 2 * table["wheel_inertia_kgm2"]
        taken.append(Part(0.05 * table["mass_kg"], each["hinge_x_m"], each["hinge_y_m"], inertia))
        bodies.append(each | {"mass_kg": taken[-1].mass_kg, "yaw_inertia_kgm2": inertia})
    if not taken:
        return table
    rest = _carriage(table).without(taken)
    return table | {"body": bodies, "mass_kg": rest.mass_kg, "com_x_m": rest.x_m, "com_y_m": rest.y_m,
                    "yaw_inertia_kgm2": rest.inertia_kgm2}


# ---- Gazebo

def sdf_of(robot: Robot) -> str:
    """The robot and a level ground."""
    table, height_m = robot.scene.vehicle, robot.wheels[0].radius_m
    on_base = [wheel.mass for wheel in robot.wheels if wheel.body == "carriage"]
    rest = robot.body["carriage"].without(on_base)
    com_z_m = table["com_z_m"] + sum(each.mass_kg for each in on_base) * (table["com_z_m"] - height_m) / rest.mass_kg
    places = {(sign * each["x_m"], each["y_m"]) for each in table["support"] for sign in (1, -1)}
    links = [_link("base", "<pose>0 0 0 0 0 0</pose>", rest, com_z_m, (rest.inertia_kgm2,) * 3, "".join(
        _ball(f"ball{at}", f"{x} {y} {height_m / 2}", height_m / 2, "<mu>0</mu><mu2>0</mu2>")
        for at, (x, y) in enumerate(sorted(places))))]
    for each, hinge in zip(robot.hinges, robot.scene.hinges, strict=True):
        name = each["name"]
        fork = robot.body[name].without([wheel.mass for wheel in robot.wheels if wheel.body == name])
        links += [_link(name, f'<pose>{each["hinge_x_m"]} {each["hinge_y_m"]} {height_m} 0 0 {hinge.start_angle_rad}'
                        "</pose>", fork, 0.0, (fork.inertia_kgm2,) * 3),
                  _joint(f"hinge_{name}", "base", name, each.get("damping_Nms", 0.0))]
    links += [_wheel(robot, at, wheel) for at, wheel in enumerate(robot.wheels)]
    ground = ('<model name="ground"><static>true</static><link name="l"><collision name="c"><geometry><plane>'
              "<normal>0 0 1</normal><size>100 100</size></plane></geometry><surface><friction><ode>"
              "<mu>10</mu><mu2>10</mu2></ode></friction></surface></collision></link></model>")
    return ('<?xml version="1.0"?><sdf version="1.9" xmlns:ignition="http://ignitionrobotics.org/schema">'
            f'<world name="w"><gravity>0 0 {-GRAVITY}</gravity>{ground}<model name="robot">'
            f"{''.join(links)}</model></world></sdf>")


def _link(name: str, pose: str, mass: Part, z_m: float, inertia: Sequence[float], inside: str = "") -> str:
    moments = "".join(f"<i{axis}{axis}>{each}</i{axis}{axis}>" for axis, each in zip("xyz", inertia, strict=True))
    return (f'<link name="{name}">{pose}<inertial><pose>{mass.x_m} {mass.y_m} {z_m} 0 0 0</pose>'
            f"<mass>{mass.mass_kg}</mass><inertia>{moments}<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"
            f"{inside}</link>")


def _ball(name: str, place: str, radius_m: float, friction: str) -> str:
    return (f'<collision name="{name}"><pose>{place} 0 0 0</pose><geometry><sphere><radius>{radius_m}</radius></sphere>'
            f"</geometry><surface><friction><ode>{friction}</ode></friction></surface></collision>")


def _joint(name: str, parent: str, child: str, damping: float) -> str:
    return (f'<joint name="{name}" type="revolute"><parent>{parent}</parent><child>{child}</child><axis>'
            f"<xyz>0 0 1</xyz><dynamics><damping>{damping}</damping></dynamics><limit><lower>-1e16</lower>"
            "<upper>1e16</upper></limit></axis></joint>")


def _wheel(robot: Robot, at: int, wheel: Wheel) -> str:
    is_on_base, across, along = wheel.body == "carriage", robot.friction, ""
    if wheel.roller_rad is not None:
        angle, across = wheel.axle_rad + wheel.roller_rad, 0.0
        along = f'<fdir1 ignition:expressed_in="base">{math.cos(angle)} {math.sin(angle)} 0</fdir1>'
    parent = "base" if is_on_base else wheel.body
    pose = (f'<pose relative_to="{parent}">{wheel.mass.x_m} {wheel.mass.y_m} {wheel.radius_m if is_on_base else 0} '
            f"{-math.pi / 2} 0 {wheel.axle_rad + math.pi / 2}</pose>")
    upright = wheel.mass.inertia_kgm2
    return (_link(f"wheel{at}", pose, replace(wheel.mass, x_m=0.0, y_m=0.0), 0.0,
                  (upright, upright, wheel.spin_kgm2), _ball(
                      "c", "0 0 0", wheel.radius_m, f"<mu>{robot.friction}</mu><mu2>{across}</mu2>{along}"))
            + _joint(f"axle{at}", parent, f"wheel{at}", 0.0))


def program(folder: Path) -> tuple[Path, str] | None:
    """The compiled program and DART's plugin; None where Gazebo's physics or a compiler is absent."""
    compiler, finder = shutil.which("g++"), shutil.which("pkg-config")
    if compiler is None or finder is None:
        return None
    found = subprocess.run([finder, "--cflags", "--libs", *PACKAGES], capture_output=True, text=True, check=False)
    place = subprocess.run([finder, "--variable=libdir", PACKAGES[0]], capture_output=True, text=True, check=False)
    plugin = Path(place.stdout.strip(), "libignition-physics5-dartsim-plugin.so")
    if found.returncode or not plugin.is_file():
        return None
    made = folder / "gazebo"
    subprocess.run([compiler, "-O2", "-std=c++17", SOURCE, "-o", made, *found.stdout.split()], check=True)
    return made, str(plugin)


def theirs(tool: tuple[Path, str], folder: Path, robot: Robot, step_s: float) -> tuple[Pose, float]:
    """The same by Gazebo's physics; no numbers where DART aborts, as positions grow unbounded."""
    file, carriage = folder / "robot.sdf", robot.body["carriage"]
    file.write_text(sdf_of(robot), encoding="utf-8")
    motors = [wheel.motor for wheel in robot.wheels if wheel.motor]
    given = np.hstack([voltages_of(robot, step_s) * [gain for gain, _ in motors], angles_of(robot, step_s)])
    done = subprocess.run([tool[0], tool[1], file, str(step_s), str(len(robot.driven)),
                           *(f"axle{at}" for at in robot.driven), *(f"hinge_{name}" for name in robot.steered),
                           *(str(damping) for _, damping in motors)],
                          capture_output=True, text=True, check=False, input="\n".join(
                              " ".join(f"{each:.12g}" for each in row) for row in given.tolist()))
    if done.returncode == -signal.SIGABRT:
        return (math.nan,) * 3, math.nan
    if done.returncode:
        raise Unusable(f"Gazebo's physics, {robot.scene.name}: {done.stderr.strip()}")
    x_m, y_m, heading_rad, cost = map(float, done.stdout.splitlines()[-1].split())
    place = complex(x_m, y_m) + complex(carriage.x_m, carriage.y_m) * (np.exp(1j * heading_rad) - 1)
    return (float(place.real), float(place.imag), heading_rad), cost


def voltages_of(robot: Robot, step_s: float) -> np.ndarray:
    """The voltages in the middle of each step, a column for each motor."""
    middles = (np.arange(round(robot.scene.run.duration_s / step_s)) + 0.5) * step_s
    of_signal = {each.signal: each for each in robot.scene.inputs}
    given = [of_signal[f"voltage_V[{at + 1}]"] for at in robot.driven]
    return np.column_stack([
        np.array((0.0, *each.value))[np.searchsorted(each.t_s, middles)] if each.kind == "steps" else each.at(middles)
        for each in given])


def angles_of(robot: Robot, step_s: float) -> np.ndarray:
    """The angles of steered bodies at the end of each step, as this core has them."""
    steps = round(robot.scene.run.duration_s / step_s)
    if not robot.steered:
        return np.zeros((steps, 0))
    signals = [f"hinge_angle_rad[{name}]" for name in robot.steered]
    every = replace(robot.scene.outputs, every_s=step_s)
    run = simulate(replace(robot.scene.with_step(step_s), outputs=every), signals)
    return np.column_stack([run.columns_of(name).ravel() for name in signals])[1:]


# ---- this core

def ours(robot: Robot, step_s: float) -> tuple[Pose, float]:
    """Where the carriage's centre of mass is at the end by this core, if it began in the origin; and µs a step."""
    scene = robot.scene.with_step(step_s)
    run = simulate(replace(scene, outputs=replace(scene.outputs, every_s=scene.run.duration_s)),
                   ("x_m", "y_m", "heading_rad"), watched=False)
    x_m, y_m, heading_rad = (float(run.columns_of(name).ravel()[-1]) for name in ("x_m", "y_m", "heading_rad"))
    return (x_m, y_m, heading_rad), 1e6 * run.seconds / run.steps


# ---- the third program

def with_limits_of_dart(robot: Robot, step_s: float) -> Pose:
    """Pose at the end of a mecanum robot with its centre of mass in the middle, if no wheel's friction is above μ times
    the load that it would carry in a step without friction: weight, and the motors' torques on the body."""
    table, wheels = robot.scene.vehicle, robot.wheels
    places = np.array([(wheel.mass.x_m, wheel.mass.y_m) for wheel in wheels])
    angles = [wheel.axle_rad + (wheel.roller_rad or 0.0) for wheel in wheels]
    along = np.column_stack([np.cos(angles), np.sin(angles)])
    gain, damping = np.array([wheel.motor or (0.0, 0.0) for wheel in wheels]).T
    spin = np.array([wheel.spin_kgm2 for wheel in wheels])
    rows = np.column_stack([along, places[:, 0] * along[:, 1] - places[:, 1] * along[:, 0],
                            -np.diag(along[:, 0] * [wheel.radius_m for wheel in wheels])])
    mobility = 1 / np.concatenate([[table["mass_kg"]] * 2, [table["yaw_inertia_kgm2"]], spin + step_s * damping])
    softness = (rows * mobility) @ rows.T
    statics = np.linalg.pinv(np.vstack([np.ones(len(wheels)), places.T]))
    speed, impulse, place, heading = np.zeros(3 + len(wheels)), np.zeros(len(wheels)), 0j, 0.0
    for voltage in voltages_of(robot, step_s):
        torque = gain * voltage - damping * speed[3:]
        most = robot.friction * step_s * np.maximum(
            statics @ [table["mass_kg"] * GRAVITY, -torque.sum(), 0.0], 0.0)
        speed[3:] += step_s * torque * mobility[3:]
        impulse = _within(softness, rows @ speed, impulse, most)
        speed += mobility * (rows.T @ impulse)
        turn = speed[2] * step_s
        place += step_s * complex(*speed[:2]) * np.exp(1j * (heading + turn / 2))
        heading += turn
        turned = complex(*speed[:2]) * np.exp(-1j * turn)
        speed[:2] = turned.real, turned.imag
    return place.real, place.imag, heading


def _within(softness: np.ndarray, slip: np.ndarray, impulse: np.ndarray, most: np.ndarray) -> np.ndarray:
    """Impulses that stop the slips, each within its limit: projected Gauss-Seidel."""
    found = impulse.copy()
    for _ in range(1000):
        before = found.copy()
        for i in range(len(found)):
            found[i] = np.clip(found[i] - (slip[i] + softness[i] @ found) / softness[i, i], -most[i], most[i])
        if np.abs(found - before).max() < 1e-12:
            break
    return found


# ---- results

@dataclass(frozen=True)
class Row:
    """One run of one program."""

    robot: str
    program: str
    step_s: float
    error_mm: float
    error_mrad: float
    cost_us: float


def compared(tool: tuple[Path, str], folder: Path) -> list[Row]:
    """All robots in all steps."""
    file = folder / "slipping.toml"
    file.write_text(SLIPPING, encoding="utf-8")
    scenes = {name: read_scene(scene) for name, scene in SCENES.items()}
    rows = []
    for name, scene in (scenes | {SLIPS: read_scene(file)}).items():
        robot = robot_of(scene)
        runs = [("Gazebo", step_s, *theirs(tool, folder, robot, step_s)) for step_s in STEPS_S]
        runs += [("laconic", step_s, *min((ours(robot, step_s) for _ in range(5)), key=lambda found: found[1]))
                 for step_s in OURS_S]
        rows += _rows(name, runs, ours(robot, REFERENCE_S)[0])
        if name == SLIPS:
            rows += _rows(OWN_LOADS, runs[: len(STEPS_S)], with_limits_of_dart(robot, THIRD_S))
    return rows


def _rows(name: str, runs: Sequence[tuple[str, float, Pose, float]], right: Pose) -> list[Row]:
    return [Row(name, which, step_s, 1e3 * math.hypot(end[0] - right[0], end[1] - right[1]),
                1e3 * abs(math.remainder(end[2] - right[2], 2 * math.pi)), cost) for which, step_s, end, cost in runs]


def picture(rows: Sequence[Row], file: Path) -> None:
    """Error against step, narrow, with its legend below: so it is legible on a telephone."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot
    from matplotlib.lines import Line2D

    mpl.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "gazebo", "font.size": 10})
    figure, axes = pyplot.subplots(figsize=(4.4, 5.6), layout="constrained")
    marks, names = {"Gazebo": "o-", "laconic": "s--"}, list(dict.fromkeys(row.robot for row in rows))
    for at, name in enumerate(names):
        for which, mark in marks.items():
            points = [(1e3 * row.step_s, max(row.error_mm, 1e-9)) for row in rows
                      if (row.robot, row.program) == (name, which) and not math.isnan(row.error_mm)]
            if points:
                axes.loglog(*zip(*points, strict=True), mark, color=f"C{at}")
    steps_ms = sorted({1e3 * row.step_s for row in rows})
    axes.set_xticks(steps_ms, [f"{each:g}" for each in steps_ms])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("step in ms")
    axes.set_ylabel("error of the place at the end in mm\n(less than 1e-9 is drawn there)")
    lines = {name: Line2D([], [], color=f"C{at}", linewidth=3) for at, name in enumerate(names)}
    lines |= {which: axes.plot([], [], mark, color="k")[0] for which, mark in marks.items()}
    figure.legend(lines.values(), lines.keys(), fontsize=10, loc="outside lower center", ncols=2, frameon=False)
    figure.savefig(file, metadata={"Date": None})


def arguments(parser: argparse.ArgumentParser) -> None:
    """Where the program and the picture go."""
    parser.add_argument("--out", type=Path, default=build_dir() / "gazebo", help="folder")


def run(options: argparse.Namespace) -> bool:
    """Prints the table, and writes the picture."""
    folder: Path = options.out
    folder.mkdir(parents=True, exist_ok=True)
    tool = program(folder)
    if tool is None:
        print("gazebo: skipped, as it needs g++, pkg-config and Debian's libignition-physics-dev")
        return True
    rows = compared(tool, folder)
    print("| robot | program | step in ms | error in mm | error in mrad | µs a step |\n"
          "| --- | --- | --- | --- | --- | --- |")
    for row in rows:
        found = "aborts | – | –" if math.isnan(row.error_mm) else (
            f"{row.error_mm:.2g} | {row.error_mrad:.2g} | {row.cost_us:.2g}")
        print(f"| {row.robot} | {row.program} | {1e3 * row.step_s:g} | {found} |")
    picture(rows, folder / "gazebo.svg")
    print(f"wrote {folder / 'gazebo.svg'}")
    return True
