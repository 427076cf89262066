"""What the Kalman filter costs on a Cortex-M4F: instructions of each part of a cycle under QEMU, stack, flash and RAM;
and whether its bits are the host's. Readings are recorded on the host: a robot with noise on its voltages, encoders
of 2,000 counts a turn and a gyro.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from laconic.core import load
from laconic.errors import BadInput
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.control.filter import Filter
from laconic.tools.report.counting import CALIBRATED_INSTRUCTIONS, lines_of_board, stopped_early
from laconic.tools.report.workshop import BENCH, M4F, Target, Variant, Workshop, run_tool
from laconic.tools.trim.scene_files import initializer

CYCLES, STEP_S, COUNTS = 100, 0.01, 2000
VOLTS = 8.0
PARTS = {"predict": "prediction", "encoders": "encoders", "yaw_rate": "gyro"}
SETTINGS = {"voltage_noise_V_per_sqrt_Hz": 0.1, "force_noise_N_per_sqrt_Hz": 0.05, "moment_noise_Nm_per_sqrt_Hz": 0.005,
            "slip_noise_m_per_s_per_sqrt_Hz": 1e-3, "yaw_slip_noise_rad_per_s_per_sqrt_Hz": 2e-3,
            "bias_noise_rad_per_s2_per_sqrt_Hz": 1e-4, "position_std_m": 0.05, "heading_std_rad": 0.1,
            "bias_std_rad_per_s": 0.03, "yaw_rate_std_rad_per_s": 8e-3}
ROOTS = ("laconic_filter_start", "laconic_filter_encoders", "laconic_filter_yaw_rate")
ROBOTS = (("robotino2", EXPLICIT), ("robotino2", "auto"), ("kuka_youbot", "auto"), ("turtlebot3_burger", "auto"))


@dataclass(frozen=True)
class FilterCost:
    """Of one robot and method on a board."""

    method: str                     # that steps
    instructions: dict[str, float]  # by part of a cycle
    stack_bytes: int
    flash_bytes: int  # filter, derivatives and steps of the scene's method, with the robot's constants
    whole_flash_bytes: int  # the same of every method, as laconic_filter_predict() links them
    filter_bytes: int  # of RAM: the laconic_filter
    same_bits: bool


def rows() -> list[dict[str, Any]]:
    """One a robot and method, in single precision; BadInput where compiler or emulator are missing."""
    if not M4F.present:
        raise BadInput("no arm-none-eabi-gcc with its C library, or no qemu-system-arm here: install both")
    found = []
    with TemporaryDirectory() as folder:
        workshop = Workshop(Path(folder))
        for name, method in ROBOTS:
            cost = cost_of(workshop, read_scene(name).with_run(method=method, step_s=STEP_S))
            parts = {PARTS[part]: round(count) for part, count in cost.instructions.items()}
            found.append({"who": f"{name}, {cost.method}", **parts, "cycle": round(sum(cost.instructions.values())),
                          "stack": cost.stack_bytes, "flash": cost.flash_bytes, "whole": cost.whole_flash_bytes,
                          "ram": cost.filter_bytes,
                          "same_bits": "yes" if cost.same_bits else "NO"})
    return found


def cost_of(workshop: Workshop, scene: Scene, board: Target = M4F, real: str = "single") -> FilterCost:
    """Builds for the board, runs there and here."""
    variant, recording = Variant(scene, real), recorded(scene, real)
    source = recording.source()
    ran = run_on_board(board, image_of(workshop, board, variant, source))
    method = workshop.files(variant)[1].method
    by_one = ("laconic_filter_predict_by", derivation_of(scene))
    return FilterCost(method, ran.instructions, ran.stack_bytes, flash_of(workshop, board, variant, source, *by_one),
                      flash_of(workshop, board, variant, source, "laconic_filter_predict"), ran.filter_bytes,
                      ran.estimate == recording.estimate(scene))


def derivation_of(scene: Scene) -> str:
    """The core's name of what differentiates the scene's steps; of auto that of the row of methods that it chose."""
    method = scene.run.method
    if method == "auto":
        plant = scene.plant(load("double"))  # owns the memory of its integrator
        method = f"auto_{'fast' if plant.c.integrator.stiff else 'slow'}"
    return f"laconic_derivation_of_{method.replace('-', '_')}"


# ---- recorded readings


@dataclass(frozen=True)
class Recording:
    """What a robot with noise on its voltages showed, cycle by cycle, in the scalar type."""

    real: str
    voltage_V: np.ndarray    # (CYCLES, N): what the filter is told
    turned_rad: np.ndarray   # (CYCLES, N)
    yaw_rate_rad_per_s: np.ndarray
    settings: dict[str, Any]

    def source(self) -> str:
        """bench_readings.c."""
        core = load(self.real)
        settings = core.ffi.new("laconic_filter_settings *", self.settings)
        rows = [f"{{{{{literals(volts)}}}, {{{literals(turned)}}}, {literals([yaw_rate])}}}" for volts, turned, yaw_rate
                in zip(self.voltage_V, self.turned_rad, self.yaw_rate_rad_per_s, strict=True)]
        return ('#include "filter.h"\n\nconst laconic_filter_settings bench_filter_settings = '
                f"{initializer(core.ffi, settings[0], {})};\n"
                f"const bench_reading bench_readings[] = {{\n    {(',' + chr(10) + '    ').join(rows)}}};\n"
                f"const uint32_t bench_reading_count = {len(rows)};\n")

    def estimate(self, scene: Scene) -> list[str]:
        """The filter of this machine's library after all cycles, as the image writes it."""
        known = Filter(scene.plant(load(self.real)), self.settings)
        for volts, turned, yaw_rate in zip(self.voltage_V, self.turned_rad, self.yaw_rate_rad_per_s, strict=True):
            known.predict({"voltage_V": volts.tolist()})
            known.encoders(turned)
            known.yaw_rate(float(yaw_rate))
        return list(estimate_lines(known))


def recorded(scene: Scene, real: str) -> Recording:
    """From a run of the scene's vehicle on this machine."""
    core, random, wheels = load(real), np.random.default_rng(6), scene.wheel_count
    plant = scene.plant(core)
    sensors = plant.sensors({"encoder": {"counts_per_turn": COUNTS},
                             "imu": {"yaw_rate_bias_rad_per_s": 0.02, "seed": 3,
                                     "yaw_rate_noise_rad_per_s_per_sqrt_Hz": 1e-3}})
    volts = VOLTS * np.sin(0.03 * np.arange(CYCLES)[:, None] + np.arange(wheels))
    counts, yaw_rates = [np.zeros(wheels)], []
    for row in volts:
        sensors.run({"voltage_V": (row + 0.3 * random.normal(size=wheels)).tolist()})
        shown = sensors.read()
        counts.append(shown.encoder_count)
        yaw_rates.append(shown.imu_yaw_rate_rad_per_s)
    angle = 2 * np.pi / COUNTS
    turned = angle * np.diff(counts, axis=0)
    return Recording(real, volts.astype(core.dtype), turned.astype(core.dtype), np.array(yaw_rates, core.dtype),
                     SETTINGS | {"encoder_std_rad": [0.41 * angle] * wheels})


def literals(values: Any) -> str:
    """A list of C literals, all digits."""
    return ", ".join(f"{float(value):.17g}" for value in values)


def estimate_lines(known: Filter) -> Iterator[str]:
    """As bench_write_filter() writes it."""
    ffi, state, factors = known.core.ffi, known.c.state, known.c.covariance

    def line(name: str, of: Any, *member: Any) -> str:
        at = ffi.addressof(of, *member)
        return f"{name} {bytes(ffi.buffer(at))[::-1].hex()}"

    sums = [*(("zeta", each) for each in state.zeta), ("x", state.x_m), ("y", state.y_m)]
    for name, each in sums:
        yield from (line(name, each, member) for member in ("value", "rest"))
    yield line("turns", state.heading, "turns")
    yield line("heading", state.heading, "fraction")
    for each in state.travel:
        yield from (line("travel", each, member) for member in ("value", "rest"))
    yield line("bias", known.c, "bias_rad_per_s")
    for i in range(known.c.errors):
        yield line("variance", factors, "diagonal", i)
        yield from (line("covariance", factors, "upper", i, j) for j in range(i + 1, known.c.errors))


# ---- images


def image_of(workshop: Workshop, target: Target, variant: Variant, source: str) -> Path:
    """Counts the cycles on a board."""
    board, startup = BENCH / "cortex_m", BENCH.parent / "cortex_m"
    return workshop.filter_image(
        target, variant, source, [startup / "startup.c", board / "bench_board.c", board / "count_filter.c"],
        [f"-I{board}", f"-I{startup}", "-ffreestanding", "-nostartfiles", f"-L{startup}", f"-T{target.script}"])


def flash_of(workshop: Workshop, target: Target, variant: Variant, source: str, predict: str, *others: str) -> int:
    """Bytes that the filter's functions, all they reach and the robot's constants take; `predict` is the function that
    predicts, `others` are what the program names besides."""
    kept = [f"-Wl,-u,{name}" for name in (*ROOTS, *others, "laconic_scene_model", "laconic_scene_integrator")]
    image = workshop.filter_image(target, variant, source, [], [
        "-nostartfiles", "-ffreestanding", f"-Wl,-e,{predict}", "-Wl,-Ttext=0x1000", *kept])
    text, data, _ = (int(each) for each in run_tool([target.tool("size"), str(image)]).splitlines()[1].split()[:3])
    return text + data


@dataclass(frozen=True)
class BoardRun:
    """What an image wrote."""

    instructions: dict[str, float]
    stack_bytes: int
    filter_bytes: int
    estimate: list[str]


def run_on_board(target: Target, image: Path) -> BoardRun:
    """Runs a counting image."""
    lines, exit_status = lines_of_board(target, image)
    values = {name: int(text) for name, _, text in (line.partition(" ") for line in lines) if text.isdecimal()}
    if exit_status != 0 or values.get("status") != 0 or "end" not in lines:
        raise stopped_early(target, image, lines)
    per_instruction = values["calibration"] / CALIBRATED_INSTRUCTIONS
    counts = {part: (values[part] / values["cycles"] - values["overhead"]) / per_instruction for part in PARTS}
    stacks = [int(line.split()[1]) for line in lines if line.startswith("stack ")]
    return BoardRun(counts, max(stacks), values["filter"], lines[lines.index("estimate") + 1 : lines.index("end")])
