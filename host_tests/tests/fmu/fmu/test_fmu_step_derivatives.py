"""Derivatives of communication steps: the bits of the core's, against differences of the FMU's own steps, transposed,
after a saved state, and where there are none."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_importer import ERROR, OK, Importer
from fmu_saved_states import SUFFIX, deserialize, save, serialize

from laconic.cli.main import run
from laconic.core import load
from laconic.core.plant import Plant
from laconic.fmu import make_fmu
from laconic.scene import read_scene

STATES = ("nu_rad_per_s", "x_m", "y_m", "heading_rad", "wheel_angle_rad")
HELD = {"voltage_V": [3.0, -2.0, 5.0], "axle_torque_Nm": [0.1, 0.0, -0.2], "body_force_N": [2.0, -1.0],
        "body_moment_Nm": [0.3], "world_force_N": [4.0, 1.0], "world_force_point_m": [0.05, -0.1]}
OUTPUTS = (*STATES, "origin_x_m", "yaw_rate_rad_per_s", "wheel_speed_rad_per_s", "wheel_torque_Nm", "wheel_reaction_N",
           "energy_J", "acceleration_body_m_per_s2")
H = 0.01
VARIANTS = [(2, False), (3, False), (3, True)]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[int, bool], Path]:
    """The FMUs of a scene with derivatives."""
    folder, scene = tmp_path_factory.mktemp("fmu"), read_scene("robotino2").with_run(step_s=H)
    return {(version, scalar): make_fmu(scene, folder / f"{version}{scalar}.fmu", version=version, scalar=scalar,
                                        derivatives=True) for version, scalar in VARIANTS}


@pytest.fixture(params=VARIANTS)
def stepped(request: pytest.FixtureRequest, made) -> Iterator[Importer]:
    """An instance after three steps with all inputs."""
    with Importer(made[request.param], logging=True) as importer:
        importer.initialize()
        set_inputs(importer)
        for k in range(3):
            assert importer.step(k * H, H) == OK
        yield importer


def set_inputs(importer: Importer) -> None:
    """All of them."""
    for name, values in HELD.items():
        assert importer.set(name, *values) == OK


def plant_after(steps: int) -> Plant:
    """The core's plant of the same run."""
    plant = read_scene("robotino2").with_run(step_s=H).plant(load("double"))
    plant.run(HELD, steps=steps)
    return plant


def elements(importer: Importer, names: tuple[str, ...]) -> list[str]:
    """Their scalars where the FMU has such, else the arrays."""
    return [each for name in names for each in importer.elements(name)[0]]


def count(importer: Importer, names: tuple[str, ...]) -> int:
    """Of all their numbers."""
    return sum(importer.size(name) for name in names)


def row(importer: Importer, names: tuple[str, ...]) -> np.ndarray:
    """All their values."""
    return np.array([value for name in names for value in importer.get(name)])


def ask(importer: Importer, kind: str, unknowns: tuple[str, ...], knowns: tuple[str, ...],
        seed: np.ndarray) -> tuple[int, np.ndarray]:
    """Get<kind>Derivative: its status and the sensitivities."""
    size = count(importer, knowns if kind == "Adjoint" else unknowns)
    first, second, result = elements(importer, unknowns), elements(importer, knowns), importer.ffi.new("double[]", size)
    seeds = importer.ffi.new("double[]", list(seed))
    more = (seeds, len(seed), result, size) if importer.version == 3 else (seeds, result)
    status = importer.call(f"Get{kind}Derivative", importer.references(*first), len(first),
                           importer.references(*second), len(second), *more)
    return status, np.array(list(result))


def jacobian(importer: Importer, unknowns: tuple[str, ...], knowns: tuple[str, ...]) -> np.ndarray:
    """Column by column."""
    found = [ask(importer, "Directional", unknowns, knowns, seed) for seed in np.eye(count(importer, knowns))]
    assert all(status == OK for status, _ in found), importer.log[-1:]
    return np.array([column for _, column in found]).T


def test_one_internal_step_has_the_bits_of_the_core(stepped: Importer) -> None:
    step = plant_after(2).step_derivatives(HELD).jacobian(world_force=True)
    assert np.array_equal(jacobian(stepped, STATES, STATES), step.by_state)
    assert np.array_equal(jacobian(stepped, STATES, tuple(HELD)), step.by_input)


def test_many_internal_steps_and_all_outputs_are_as_differences_of_the_fmus_own_steps_say(stepped: Importer) -> None:
    start, small, size = save(stepped), 1e-5, 20 * H
    columns = []
    for name, values in HELD.items():
        for k in range(len(values)):
            ends = []
            for sign in (1.0, -1.0):
                stepped.must(f"Set{SUFFIX[stepped.version]}", start[0])
                assert stepped.set(name, *(x + sign * small * (i == k) for i, x in enumerate(values))) == OK
                assert stepped.step(3 * H, size) == OK
                ends.append(row(stepped, OUTPUTS))
            columns.append((ends[0] - ends[1]) / (2.0 * small))
            assert stepped.set(name, *values) == OK
    stepped.must(f"Set{SUFFIX[stepped.version]}", start[0])
    assert stepped.step(3 * H, size) == OK
    exact, rough = jacobian(stepped, OUTPUTS, tuple(HELD)), np.array(columns).T
    assert np.abs(exact).max() > 1.0
    np.testing.assert_allclose(exact, rough, rtol=2e-7, atol=2e-7 * np.abs(rough).max())


def test_by_the_states_at_the_start_as_differences_of_runs_that_start_elsewhere_say(made) -> None:
    def end(importer: Importer, nu: list[float], heading: float) -> np.ndarray:
        assert importer.set("start_nu_rad_per_s", *nu) == OK
        assert importer.set("start_heading_rad", heading) == OK
        importer.initialize()
        set_inputs(importer)
        assert importer.step(0.0, 5 * H) == OK
        return row(importer, OUTPUTS)

    nu, heading, small, ends = np.array([1.0, -2.0, 3.0]), 0.5, 1e-5, []
    for moved in (*np.eye(4), *-np.eye(4)):
        with Importer(made[3, False]) as importer:
            ends.append(end(importer, list(nu + small * moved[:3]), heading + small * moved[3]))
    rough = (np.array(ends[:4]) - np.array(ends[4:])).T / (2.0 * small)
    with Importer(made[3, False]) as importer:
        end(importer, list(nu), heading)
        exact = jacobian(importer, OUTPUTS, ("nu_rad_per_s", "heading_rad"))
    np.testing.assert_allclose(exact, rough, rtol=2e-7, atol=2e-7 * np.abs(rough).max())


def test_the_adjoint_is_the_transpose(made) -> None:
    with Importer(made[3, False]) as importer:
        importer.initialize()
        set_inputs(importer)
        assert importer.step(0.0, 10 * H) == OK
        knowns = (*STATES, *HELD)
        matrix = jacobian(importer, OUTPUTS, knowns)
        seed = np.random.default_rng(1).normal(size=len(matrix))
        status, found = ask(importer, "Adjoint", OUTPUTS, knowns, seed)
    assert status == OK
    assert np.all(np.abs(found - seed @ matrix) <= 1e-14 * (np.abs(seed) @ np.abs(matrix)))


def test_a_saved_state_brings_the_derivatives_of_its_last_step_back(stepped: Importer, made) -> None:
    before = jacobian(stepped, OUTPUTS, tuple(HELD))
    state, data = save(stepped), serialize(stepped)
    assert stepped.set("voltage_V", 0.0, 0.0, 9.0) == OK
    assert stepped.step(3 * H, 7 * H) == OK
    assert not np.array_equal(jacobian(stepped, OUTPUTS, tuple(HELD)), before)
    stepped.must(f"Set{SUFFIX[stepped.version]}", state[0])
    assert np.array_equal(jacobian(stepped, OUTPUTS, tuple(HELD)), before)
    variant = (stepped.version, "voltage_V[1]" in stepped.variables and stepped.version == 3)
    with Importer(made[variant]) as other:
        other.initialize()
        assert deserialize(other, data) == OK
        assert np.array_equal(jacobian(other, OUTPUTS, tuple(HELD)), before)


def test_inputs_that_are_set_afterwards_leave_the_derivatives_as_they_were(stepped: Importer) -> None:
    before = jacobian(stepped, OUTPUTS, tuple(HELD))
    assert stepped.set("world_force_N", 50.0, -20.0) == OK
    assert np.array_equal(jacobian(stepped, OUTPUTS, tuple(HELD)), before)
    assert stepped.step(3 * H, 1.5 * H) != OK
    assert np.array_equal(jacobian(stepped, OUTPUTS, tuple(HELD)), before)


def test_a_step_that_has_no_derivatives_says_why(made) -> None:
    def touch(environment, time_s, *_) -> None:
        importer.set("voltage_V", 1.0, time_s, 0.0)

    with Importer(made[3, False], update=touch, logging=True) as importer:
        importer.initialize()
        assert importer.step(0.0, 2 * H) == OK
        assert ask(importer, "Directional", ("x_m",), ("voltage_V",), np.ones(3))[0] == ERROR
        assert "inputs were set within it" in importer.log[-1][2]
    with Importer(made[2, False], logging=True) as importer:
        importer.initialize()
        importer.must("SetRealInputDerivatives", importer.references("voltage_V[1]"), 1, [1], [2.0])
        assert importer.step(0.0, H) == OK
        assert ask(importer, "Directional", ("x_m",), ("voltage_V",), np.ones(3))[0] == ERROR
        assert "its inputs had slopes" in importer.log[-1][2]
        assert importer.step(H, H) == OK
        assert ask(importer, "Directional", ("x_m",), ("voltage_V",), np.ones(3))[0] == OK
        assert importer.set("motor_damping_Nms", 2.0) == OK
        assert ask(importer, "Directional", ("x_m",), ("voltage_V",), np.ones(3))[0] == ERROR
        assert "the vehicle has changed since" in importer.log[-1][2]


def test_the_description_is_valid_and_for_co_simulation_whose_outputs_depend_on_all(made) -> None:
    for fmu in made.values():
        assert validate_fmu(str(fmu)) == []
        with Importer(fmu) as importer:
            root = ET.parse(importer.folder / "modelDescription.xml").getroot()
        flags = root.find("CoSimulation").attrib
        assert root.find("ModelExchange") is None
        assert flags.get("providesDirectionalDerivative", flags.get("providesDirectionalDerivatives")) == "true"
        assert flags.get("providesAdjointDerivatives") == ("true" if root.get("fmiVersion") == "3.0" else None)
        structure = root.find("ModelStructure")
        outputs = structure.findall("Output") or structure.findall("Outputs/Unknown")
        assert outputs
        assert not any("dependencies" in output.attrib for output in outputs)


def test_before_the_first_step_they_are_those_of_the_instant(made) -> None:
    with Importer(made[3, False]) as importer:
        importer.initialize()
        assert np.array_equal(jacobian(importer, ("x_m",), ("x_m", "voltage_V")), [[1.0, 0.0, 0.0, 0.0]])


@pytest.mark.parametrize(("options", "told"), [("--fmi 2 --ssp", "an SSP archive"),
                                               ("--fmi 3 --bus can", "--derivatives")])
def test_what_does_not_go_with_derivatives_is_refused_by_name(options: str, told: str, tmp_path: Path, capsys) -> None:
    assert run(["fmu", "robotino2", "--derivatives", *options.split(), "-o", str(tmp_path / "x.fmu")]) == 2
    assert told in capsys.readouterr().err


def test_a_scene_with_friction_is_refused_with_the_remedy(tmp_path: Path, capsys) -> None:
    assert run(["fmu", "robotino_grey", "--fmi", "3", "--derivatives", "-o", str(tmp_path / "x.fmu")]) == 2
    assert "not smooth" in capsys.readouterr().err
