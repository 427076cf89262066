"""FMUs with an error estimate: the core's own numbers, beside a proved enclosure, through steps of any length, changes,
saved states and refusals; and the bits of a run, which stay."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_importer import DISCARD, ERROR, OK, Importer, generic
from fmu_saved_states import SUFFIX, deserialize, save, serialize

from laconic.cli.main import run
from laconic.core import load
from laconic.core.estimate import NAMES
from laconic.errors import BadInput
from laconic.fmu import make_fmu
from laconic.scene import read_scene
from laconic.scene.methods import EXACT, STIFF_8
from laconic.tools.enclosure.readings import reading_of_file
from laconic.tools.enclosure.study import enclose
from scene_text import MOVING_CARRIAGE

H = 0.02
VARIANTS = [(2, False), (3, False), (3, True)]
VOLTS = [3.0, -2.0, 5.0]
OUTPUTS = tuple(f"estimated_error_{which}{name}" for which in ("", "largest_", "rounding_") for name in NAMES)
STATES = ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "wheel_angle_rad")
SCENE = MOVING_CARRIAGE + """\
[[input]]
signal = "voltage_V[1]"
kind = "steps"
t_s = [0.0]
value = [3.0]
[[input]]
signal = "voltage_V[2]"
kind = "steps"
t_s = [0.0]
value = [-2.0]
[[input]]
signal = "voltage_V[3]"
kind = "steps"
t_s = [0.0]
value = [5.0]
[run]
duration_s = 1.0
step_s = 0.02
""" + f'method = "{EXACT}"\n'


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A vehicle whose voltages are held."""
    path = tmp_path_factory.mktemp("scene") / "held.toml"
    path.write_text(SCENE, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def made(scene: Path) -> dict[tuple[int, bool], Path]:
    """Its FMUs with an estimate."""
    return {(version, scalar): make_fmu(read_scene(scene), scene.parent / f"{version}{scalar}.fmu", version=version,
                                        scalar=scalar, estimate=True) for version, scalar in VARIANTS}


@pytest.fixture(params=VARIANTS)
def started(request: pytest.FixtureRequest, made) -> Iterator[Importer]:
    """An instance that has its inputs."""
    with Importer(made[request.param], logging=True) as importer:
        importer.initialize()
        assert importer.set("voltage_V", *VOLTS) == OK
        yield importer


def row(importer: Importer, names: tuple[str, ...] = OUTPUTS) -> list[float]:
    """Their values."""
    return [value for name in names for value in importer.get(name)]


def core_row(scene: Path, steps: int, window: int = 16, step_s: float = H) -> list[float]:
    """What the core's estimate says after so many steps."""
    plant = read_scene(scene).with_run(step_s=step_s).plant(load("double"))
    estimate = plant.estimate(window)
    estimate.run({"voltage_V": VOLTS}, steps=steps)
    found = estimate.read()
    return [getattr(sizes, name) for sizes in (found.now, found.largest, found.rounding) for name in NAMES]


def test_the_outputs_are_the_cores_estimate_whatever_the_communication_steps(started: Importer, scene: Path) -> None:
    done = 0
    for count in (1, 1, 7, 40, 1):
        assert started.step(done * H, count * H) == OK
        done += count
        assert row(started) == core_row(scene, done)
    assert started.get("estimated_error_unknown_windows") == [0.0]


def test_it_is_near_the_proved_error(started: Importer, scene: Path) -> None:
    given = read_scene(scene)
    reading = reading_of_file(given)
    study = enclose(reading, reading.instants([given.steps()]), None, "", shown=False)
    truth = [float(x.mid()) for x in study.end.row()]
    assert started.step(0.0, given.run.duration_s) == OK
    off = np.abs(np.array(row(started, STATES)) - truth)
    errors = max(off[:3]), math.hypot(off[3], off[4]), off[5], max(off[6:])
    for name, error in zip(NAMES, errors, strict=True):
        (estimated,) = started.get(f"estimated_error_{name}")
        (rounding,) = started.get(f"estimated_error_rounding_{name}")
        assert error > 100 * rounding > 0.0
        assert 0.1 * error < estimated < 10.0 * error
        assert started.get(f"estimated_error_largest_{name}")[0] >= estimated


def test_the_bits_of_the_run_are_those_without_an_estimate(started: Importer, scene: Path, tmp_path: Path) -> None:
    variant = {"version": started.version, "scalar": "voltage_V[1]" in started.variables and started.version == 3}
    with (Importer(make_fmu(read_scene(scene), tmp_path / "plain.fmu", **variant)) as plain,
          Importer(started.fmu, logging=True) as off):
        assert not [name for name in plain.variables if name.startswith("estimate")]
        assert off.set("estimate_error", False) == OK
        for other in (plain, off):
            other.initialize()
            assert other.set("voltage_V", *VOLTS) == OK
        for k in range(30):
            assert {each.step(3 * k * H, (1 + 2 * (k % 2)) * H if k % 2 else 3 * H)
                    for each in (started, plain, off)} == {OK}
            assert row(started, STATES) == row(plain, STATES) == row(off, STATES)
        assert set(row(off)) == {0.0}
        assert min(row(started)) > 0.0


def test_other_windows_are_the_cores(made, scene: Path) -> None:
    with Importer(made[3, False]) as importer:
        assert importer.set("estimate_window_steps", 2) == OK
        assert importer.set("step_s", 0.001) == OK
        importer.initialize()
        assert importer.set("voltage_V", *VOLTS) == OK
        assert importer.step(0.0, 0.3) == OK
        assert row(importer) == core_row(scene, 300, 2, 0.001) != core_row(scene, 300, 16, 0.001)


@pytest.mark.parametrize("window", [0, 1025])
def test_windows_of_another_length_are_refused(made, window: int) -> None:
    with Importer(made[3, False], logging=True) as importer:
        assert importer.set("estimate_window_steps", window) == ERROR
        assert "estimate_window_steps" in importer.log[-1][2]


def test_states_that_are_saved_serialized_and_reset_have_their_estimate(started: Importer, made) -> None:
    assert started.step(0.0, 21 * H) == OK
    before, state, data = row(started), save(started), serialize(started)
    assert started.step(21 * H, 10 * H) == OK
    after = row(started)
    assert after != before
    started.must(f"Set{SUFFIX[started.version]}", state[0])
    assert row(started) == before
    assert started.step(21 * H, 10 * H) == OK
    assert row(started) == after
    with Importer(started.fmu) as other:
        other.initialize()
        assert deserialize(other, data) == OK
        assert row(other) == before
        assert other.step(21 * H, 10 * H) == OK
        assert row(other) == after
        assert serialize(other) == serialize(started)
        assert deserialize(other, data[:-9]) != OK
    started.must("Reset")
    started.initialize()
    assert row(started, OUTPUTS[:8]) != after[:8]
    assert max(row(started)) < 1e-14
    started.must(f"Free{SUFFIX[started.version]}", state)


def test_a_refused_step_leaves_the_estimate_as_it_was(started: Importer) -> None:
    with Importer(started.fmu) as other:
        other.initialize()
        assert other.set("voltage_V", *VOLTS) == OK
        for importer in (started, other):
            assert importer.step(0.0, 5 * H) == OK
        assert started.set("voltage_V", 1e300, 0.0, 0.0) == OK
        for count in (1, 3):
            assert started.step(5 * H, count * H) == DISCARD
        assert row(started) == row(other)
        assert started.set("voltage_V", *VOLTS) == OK
        for k in range(20):
            for importer in (started, other):
                assert importer.step((5 + k) * H, H) == OK
            assert row(started) == row(other)


def fine_states(scene: Path, begin_s: float, load_kg: float, more_s: float) -> np.ndarray:
    """The states by eighth order, with a payload from a time on."""
    given = read_scene(scene).with_run(method=STIFF_8, step_s=0.001)
    plant = given.plant(load("double"))
    plant.run({"voltage_V": VOLTS}, steps=round(begin_s / 0.001))
    if load_kg:
        loaded = scene.with_name("loaded.toml")
        loaded.write_text(SCENE.replace("[initial]", f"[vehicle.payload]\nmass_kg = {load_kg}\nx_m = 0.1\ny_m = -0.05\n"
                                        "yaw_inertia_kgm2 = 0.02\n[initial]"), encoding="utf-8")
        plant.change(read_scene(loaded).c_vehicle(load("double")))
    plant.run({"voltage_V": VOLTS}, steps=round(more_s / 0.001))
    return np.array([*plant.nu, plant.pose.x_m, plant.pose.y_m, plant.pose.heading_rad, *plant.wheel_angles()])


def assert_near(importer: Importer, truth: np.ndarray) -> None:
    """Estimates within a factor of 10 of the errors."""
    off = np.abs(np.array(row(importer, STATES)) - truth)
    errors = max(off[:3]), math.hypot(off[3], off[4]), off[5], max(off[6:])
    found = row(importer, OUTPUTS[:4])
    assert all(0.1 * error < each < 10.0 * error for error, each in zip(errors, found, strict=True)), (errors, found)


def test_without_a_step_of_its_own_the_estimate_goes_on_over_steps_of_every_length(made, scene: Path) -> None:
    with Importer(made[3, False]) as importer:
        assert importer.set("step_s", 0.0) == OK
        importer.initialize()
        assert set(row(importer)) == {0.0}
        assert importer.set("voltage_V", *VOLTS) == OK
        now = 0.0
        for step_s, count in ((0.02, 20), (0.001, 100), (0.01, 10)):
            for _ in range(count):
                assert importer.step(now, step_s) == OK
                now += step_s
        assert_near(importer, fine_states(scene, 0.0, 0.0, now))


def test_after_a_payload_the_estimate_goes_on(made, scene: Path) -> None:
    with Importer(made[3, False]) as importer:
        importer.initialize()
        assert importer.set("voltage_V", *VOLTS) == OK
        assert importer.step(0.0, 0.4) == OK
        for name, value in (("payload_mass_kg", 3.0), ("payload_x_m", 0.1), ("payload_y_m", -0.05),
                            ("payload_yaw_inertia_kgm2", 0.02)):
            assert importer.set(name, value) == OK
        assert importer.step(0.4, 0.2) == OK
        assert_near(importer, fine_states(scene, 0.4, 3.0, 0.2))


def test_slopes_of_inputs_are_followed(made, scene: Path) -> None:
    with Importer(made[2, False]) as importer:
        h = 1.0 / 64.0  # all times are numbers
        assert importer.set("step_s", h) == OK
        importer.initialize()
        plant = read_scene(scene).with_run(step_s=h).plant(load("double"))
        estimate = plant.estimate()
        for k in range(30):
            assert importer.set("voltage_V", k * h, 0.0, 0.0) == OK
            importer.must("SetRealInputDerivatives", importer.references("voltage_V[1]"), 1, [1], [1.0])
            assert importer.step(k * h, h) == OK
            samples = [{"voltage_V": [k * h + 0.5 * j * h, 0.0, 0.0]} for j in range(3)]
            core, why = plant.core, plant.core.why()
            inputs = core.ffi.new("laconic_input[3]")
            for j, each in enumerate(samples):
                inputs[j] = plant.input_of(each)[0]
            core.check(core.lib.laconic_estimate_run_sampled(estimate.c, plant.c, inputs, why), why)
        assert row(importer, OUTPUTS[:4]) == [getattr(estimate.read().now, name) for name in NAMES]


@pytest.mark.parametrize("name", ["robotino_grey", "canopen_agv"])
def test_friction_has_it_too(name: str, tmp_path: Path) -> None:
    given = read_scene(name)
    fmu = make_fmu(given, tmp_path / "x.fmu", version=3, estimate=True)
    plant = given.plant(load("double"))
    estimate, volts = plant.estimate(), [2.0] * given.wheel_count
    estimate.run({"voltage_V": volts}, steps=50)
    with Importer(fmu) as importer:
        importer.initialize()
        assert importer.set("voltage_V", *volts) == OK
        assert importer.step(0.0, 50 * given.run.step_s) == OK
        assert row(importer, OUTPUTS[:4]) == [getattr(estimate.read().now, each) for each in NAMES]


def test_the_descriptions_are_valid_and_for_co_simulation_alone(made) -> None:
    for fmu in made.values():
        assert validate_fmu(str(fmu)) == []
        with Importer(fmu) as importer:
            assert importer.description.modelExchange is None
            assert importer.variables["estimated_error_place_m"].unit in ("m", None)
            assert importer.variables["estimated_error_place_m"].causality == "output"


def test_model_exchange_is_refused_unless_it_is_off(made) -> None:
    with Importer(made[3, False], "ModelExchange", logging=True) as importer:
        assert importer.call("EnterInitializationMode", False, 0.0, 0.0, False, 0.0) == OK
        assert importer.call("ExitInitializationMode") == ERROR
        assert "which Model Exchange does not have; use Co-Simulation, or set it to false" in importer.log[-1][2]
    with Importer(made[3, False], "ModelExchange", logging=True) as importer:
        assert importer.set("estimate_error", False) == OK
        importer.initialize()


def test_derivatives_of_estimates_are_0(started: Importer) -> None:
    assert started.step(0.0, H) == OK
    result = started.ffi.new("double *")
    more = (started.ffi.new("double[]", [1.0]), 1, result, 1) if started.version == 3 else (
        started.ffi.new("double[]", [1.0]), result)
    known = started.elements("nu_rad_per_s")[0][0]
    if started.version == 3 and known == "nu_rad_per_s":
        more = (started.ffi.new("double[]", [1.0, 0.0, 0.0]), 3, result, 1)
    status = started.call("GetDirectionalDerivative", started.references("estimated_error_place_m"), 1,
                          started.references(known), 1, *more)
    assert (status, result[0]) == (OK, 0.0)


@pytest.mark.parametrize(("options", "told"), [
    ("--fmi 2 --ssp", "an SSP archive"), ("--fmi 3 --bus can", "--estimate"),
    ("--fmi 3 --derivatives", "--derivatives")])
def test_what_does_not_go_with_an_estimate_is_refused_by_name(options: str, told: str, tmp_path: Path, capsys) -> None:
    assert run(["fmu", "robotino2", "--estimate", *options.split(), "-o", str(tmp_path / "x.fmu")]) == 2
    assert told in capsys.readouterr().err


def test_from_python_both_variants_together_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="no FMU has both"):
        make_fmu(read_scene("robotino2"), tmp_path / "x.fmu", version=3, estimate=True, derivatives=True)


def test_other_fmus_carry_nothing_of_it() -> None:
    for version in (2, 3):
        with Importer(generic(version)) as importer:
            assert not [name for name in importer.variables if name.startswith("estimate")]
            library = next(importer.folder.rglob("Laconic.so")).read_bytes()
        assert b"estimate" not in library
