"""Gazebo's physics (ign-physics 5 with DART) and this core on the same robots: error against step, and time of a step.

    python host_tests/assurance/run.py gazebo

Needs Debian's libignition-physics-dev and a C++ compiler; without them it prints one line. The reference is the core
with a step of 0.1 ms on ideal ground. Wheels in Gazebo are spheres, which touch the ground in one point, as
wheels here do.
"""

from __future__ import annotations

import argparse
import math
import shutil
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from laconic import Vehicle
from laconic.base.paths import build_dir
from laconic.core.articulated import ArticulatedVehicle

SOURCE = Path(__file__).with_name("gazebo.cc")
PACKAGES = ("ignition-physics5", "ignition-physics5-sdf", "ignition-plugin1-loader", "sdformat12")
GAIN, DAMPING, RADIUS_M, SPIN_KGM2, WHEEL_KG, UPRIGHT_KGM2 = 0.15, 0.05, 0.05, 0.000625, 0.5, 0.0004
BASE_KG, BASE_KGM2 = 8.0, 0.15
STEPS_S = (0.004, 0.002, 0.001, 0.0005)
OURS_S, REFERENCE_S = (0.02, 0.004), 1e-4
CASTER_KG, CASTER_KGM2, HINGE_M, TRAIL_M = 0.3, 0.0002, -0.2, 0.04
Pose = tuple[float, float, float]


@dataclass(frozen=True)
class Robot:
    """Wheels (name, x, y, roller angle in degrees or None), their friction in Gazebo, and voltages until when."""

    wheels: tuple[tuple[str, float, float, float | None], ...]
    friction: float
    voltages: tuple[tuple[float, ...], ...]
    has_caster: bool = False


TWO = (("l", 0.0, 0.15, None), ("r", 0.0, -0.15, None))
FOUR = (("fl", 0.2, 0.15, 45.0), ("rl", -0.2, 0.15, -45.0), ("fr", 0.2, -0.15, -45.0), ("rr", -0.2, -0.15, 45.0))
REVERSAL = ((2.0, 3.0, -3.0, -3.0, 3.0), (4.0, 4.0, 2.0, 3.0, 1.0))
ROBOTS = {"differential": Robot(TWO, 1.0, ((2.0, 3.0, 4.0), (4.0, 4.0, 1.0))),
          "caster": Robot(TWO, 8.0, ((2.0, 3.0, 4.0), (4.0, 4.0, 1.0)), has_caster=True),
          "mecanum, friction 8": Robot(FOUR, 8.0, REVERSAL), "mecanum, friction 0.8": Robot(FOUR, 0.8, REVERSAL)}


# ---- Gazebo

def sdf_of(robot: Robot) -> str:
    """The robot and a level ground."""
    links = [_link("base", "0 0 0 0 0 0", BASE_KG, (0.08, 0.1, BASE_KGM2), "" if robot.wheels is FOUR else "".join(
        _ball(f"ball{x}", f"{x} 0 -0.025", 0.025, "<mu>0</mu><mu2>0</mu2>")
        for x in ((0.2,) if robot.has_caster else (-0.12, 0.12))))]
    for name, x, y, roller in robot.wheels:
        across = "" if roller is None else (f'<fdir1 ignition:expressed_in="base">1 {-math.copysign(1, roller):g} 0'
                                            "</fdir1>")
        links.append(_wheel(name, f"{x} {y} 0", "base",
                            f"<mu>{robot.friction}</mu><mu2>{robot.friction if roller is None else 0}</mu2>{across}"))
    if robot.has_caster:
        links += [_link("fork", f"{HINGE_M} 0 0 0 0 0", CASTER_KG, (CASTER_KGM2,) * 3),
                  _joint("swivel", "base", "fork"),
                  _wheel("c", f"{HINGE_M - TRAIL_M} 0 0", "fork",
                         f"<mu>{robot.friction}</mu><mu2>{robot.friction}</mu2>")]
    ground = ('<model name="ground"><static>true</static><link name="l"><collision name="c"><geometry><plane>'
              "<normal>0 0 1</normal><size>100 100</size></plane></geometry><surface><friction><ode>"
              "<mu>10</mu><mu2>10</mu2></ode></friction></surface></collision></link></model>")
    return ('<?xml version="1.0"?><sdf version="1.9" xmlns:ignition="http://ignitionrobotics.org/schema">'
            f'<world name="w"><gravity>0 0 -9.81</gravity>{ground}<model name="robot"><pose>0 0 {RADIUS_M} 0 0 0</pose>'
            f"{''.join(links)}</model></world></sdf>")


def _link(name: str, pose: str, mass_kg: float, inertia: Sequence[float], inside: str = "") -> str:
    moments = "".join(f"<i{axis}{axis}>{each}</i{axis}{axis}>" for axis, each in zip("xyz", inertia, strict=True))
    return (f'<link name="{name}"><pose>{pose}</pose><inertial><mass>{mass_kg}</mass><inertia>{moments}<ixy>0</ixy>'
            f"<ixz>0</ixz><iyz>0</iyz></inertia></inertial>{inside}</link>")


def _ball(name: str, place: str, radius_m: float, friction: str) -> str:
    return (f'<collision name="{name}"><pose>{place} 0 0 0</pose><geometry><sphere><radius>{radius_m}</radius></sphere>'
            f"</geometry><surface><friction><ode>{friction}</ode></friction></surface></collision>")


def _joint(name: str, parent: str, child: str) -> str:
    return (f'<joint name="{name}" type="revolute"><parent>{parent}</parent><child>{child}</child><axis>'
            "<xyz>0 0 1</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis></joint>")


def _wheel(name: str, place: str, parent: str, friction: str) -> str:
    return _link(name, f"{place} {-math.pi / 2} 0 0", WHEEL_KG, (UPRIGHT_KGM2, UPRIGHT_KGM2, SPIN_KGM2), _ball(
        "c", "0 0 0", RADIUS_M, friction)) + _joint(f"j{name}", parent, name)


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
    """Pose at the end by Gazebo's physics, and µs a step."""
    file = folder / "robot.sdf"
    file.write_text(sdf_of(robot), encoding="utf-8")
    done = subprocess.run([tool[0], tool[1], file, str(step_s), str(GAIN), str(DAMPING),
                           *(f"j{wheel[0]}" for wheel in robot.wheels)], capture_output=True, text=True, check=True,
                          input="\n".join(" ".join(map(str, each)) for each in robot.voltages))
    x, y, heading, cost = map(float, done.stdout.splitlines()[-1].split())
    return (x, y, heading), cost


# ---- this core

def table_of(robot: Robot) -> dict[str, object]:
    """The same robot as a vehicle: masses of the base and of the wheels on it."""
    wheels = [{"kind": "fixed" if roller is None else "mecanum", "x_m": x, "y_m": y, "axle_rad": -math.pi / 2,
               **({} if roller is None else {"roller_rad": math.radians(roller)})} for _, x, y, roller in robot.wheels]
    upright = sum(WHEEL_KG * (x * x + y * y) + UPRIGHT_KGM2 for _, x, y, _ in robot.wheels)
    table: dict[str, object] = {
        "mass_kg": BASE_KG + WHEEL_KG * len(wheels), "yaw_inertia_kgm2": BASE_KGM2 + upright, "wheel": wheels,
        "wheel_radius_m": RADIUS_M, "wheel_inertia_kgm2": SPIN_KGM2, "motor_gain_Nm_per_V": GAIN,
        "motor_damping_Nms": DAMPING}
    if robot.has_caster:
        mass_kg = CASTER_KG + WHEEL_KG
        own_kgm2 = CASTER_KGM2 + UPRIGHT_KGM2 + CASTER_KG * WHEEL_KG / mass_kg * TRAIL_M**2
        table["body"] = [{"name": "caster", "hinge": "free", "hinge_x_m": HINGE_M, "hinge_y_m": 0.0, "mass_kg": mass_kg,
                          "com_x_m": -TRAIL_M * WHEEL_KG / mass_kg, "yaw_inertia_kgm2": own_kgm2}]
        wheels.append({"kind": "fixed", "body": "caster", "x_m": -TRAIL_M, "y_m": 0.0, "axle_rad": -math.pi / 2,
                       "driven": False})
    return table


def ours(robot: Robot, step_s: float) -> tuple[Pose, float]:
    """Pose at the end by this core, and µs a step; the vehicle's preparation does not count."""
    table = table_of(robot)
    if robot.has_caster:
        hinged = ArticulatedVehicle(table).plant("auto", step_s)
        began, before_s = time.perf_counter(), 0.0
        for until_s, *voltages in robot.voltages:
            hinged.run({f"voltage_V[{i}]": each for i, each in enumerate(voltages, 1)},
                       round((until_s - before_s) / step_s))
            before_s = until_s
        cost, end = time.perf_counter() - began, hinged.motion()
        return (end.x_m, end.y_m, end.heading_rad), 1e6 * cost * step_s / before_s
    plant = Vehicle(table).plant("auto", step_s=step_s)
    began, before_s = time.perf_counter(), 0.0
    for until_s, *voltages in robot.voltages:
        plant.run({"voltage_V": voltages}, steps=round((until_s - before_s) / step_s))
        before_s = until_s
    cost, pose = time.perf_counter() - began, plant.pose
    return (pose.x_m, pose.y_m, pose.heading_rad), 1e6 * cost * step_s / before_s


# ---- results

Row = tuple[str, str, float, float, float, float]
"""Robot, program, step in s, error in mm, error of the heading in mrad, µs a step."""


def compared(tool: tuple[Path, str], folder: Path) -> list[Row]:
    """All robots in all steps."""
    rows: list[Row] = []
    for name, robot in ROBOTS.items():
        x, y, heading = ours(robot, REFERENCE_S)[0]
        runs = [("Gazebo", step_s, *theirs(tool, folder, robot, step_s)) for step_s in STEPS_S]
        runs += [("laconic", step_s, *min((ours(robot, step_s) for _ in range(5)), key=lambda found: found[1]))
                 for step_s in OURS_S]
        rows += [(name, which, step_s, 1e3 * math.hypot(end[0] - x, end[1] - y), 1e3 * abs(end[2] - heading), cost)
                 for which, step_s, end, cost in runs]
    return rows


def picture(rows: Sequence[Row], file: Path) -> None:
    """Error against step."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(6, 4))
    for name in ROBOTS:
        for which, mark in (("Gazebo", "o-"), ("laconic", "s--")):
            points = [(row[2], max(row[3], 1e-9)) for row in rows if row[:2] == (name, which)]
            axes.loglog(*zip(*points, strict=True), mark, label=f"{name}, {which}")
    axes.set_xlabel("step in s")
    axes.set_ylabel("error of the place after 4 s in mm")
    axes.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(file)


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
    for name, which, step_s, error_mm, error_mrad, cost in rows:
        print(f"| {name} | {which} | {1e3 * step_s:g} | {error_mm:.2g} | {error_mrad:.2g} | {cost:.2g} |")
    picture(rows, folder / "gazebo.svg")
    print(f"wrote {folder / 'gazebo.svg'}")
    return True
