"""Core, FMI 2, FMI 3 and the node over CAN give the same bits, for every scene, over at least 10,000 steps."""

from __future__ import annotations

import fmpy.fmi1
import numpy as np
import pytest

from laconic.fmu import make_fmu
from laconic.scene import METHODS, Scene, read_scene, rigid_scene_names
from laconic.tools.demo.fmu_rows import fmu_rows
from laconic.tools.demo.main_job import LEAST_STEPS, steps_of
from laconic.tools.demo.rows import Rows, core_rows, difference, exchanges, node_rows

# Numbers of steps an exchange that share no factor with the changes of the inputs, nor with each other.
FMU_EVERY, NODE_EVERY = 3, 7


# Of the other scenes `laconic demo` compares every participant, and test_fmu_bits.py the FMUs.
QUICK = {"s1", "skid_steer", "kuka_youbot"}
SCENES = [pytest.param(name, marks=[] if name in QUICK else [pytest.mark.nightly]) for name in rigid_scene_names()]


def long_enough(name: str) -> Scene:
    """The scene over its own length, or 10,000 steps where that is less."""
    scene = steps_of(read_scene(name))
    assert scene.steps() >= LEAST_STEPS
    return scene


@pytest.fixture(scope="module")
def expected() -> dict[str, Rows]:
    """The core's rows after every step, kept from one participant to the next."""
    return {}


def core_of(scene: Scene, kept: dict[str, Rows]) -> Rows:
    key = f"{scene.path.stem} {scene.run.real}"
    if key not in kept:
        kept[key] = core_rows(scene, scene.steps())
    return kept[key]


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("version", [2, 3])
def test_fmu_gives_the_cores_bits(version, name, tmp_path, expected):
    scene = long_enough(name)
    fmu = make_fmu(scene, tmp_path / "scene.fmu", version=version)
    found = fmu_rows(scene, fmu, scene.steps(), FMU_EVERY)
    assert found.ticks[-1] >= LEAST_STEPS
    assert len(found.ticks) >= LEAST_STEPS // FMU_EVERY
    assert difference(found, core_of(scene, expected), scene.wheel_count) == ""


@pytest.mark.parametrize("name", SCENES)
def test_node_over_can_gives_the_cores_bits(name, expected):
    scene = long_enough(name)
    found = node_rows(scene, scene.steps(), NODE_EVERY)
    assert found.ticks[-1] >= LEAST_STEPS
    assert len(found.ticks) >= LEAST_STEPS // NODE_EVERY
    assert difference(found, core_of(scene, expected), scene.wheel_count) == ""


@pytest.mark.parametrize("name", ["s1", pytest.param("kuka_youbot", marks=pytest.mark.nightly)])
def test_node_in_single_precision_gives_the_single_cores_bits(name, expected):
    scene = long_enough(name).with_run(real="single")
    found = node_rows(scene, scene.steps(), NODE_EVERY)
    assert found.rows.dtype == np.float32
    assert difference(found, core_of(scene, expected), scene.wheel_count) == ""


@pytest.mark.parametrize("method", [
    *METHODS[1:3], *(pytest.param(each, marks=pytest.mark.nightly) for each in METHODS[3:])])
def test_every_method_gives_the_same_bits_everywhere(method, tmp_path):
    scene = read_scene("s1").with_run(method=method)
    core = core_rows(scene, 1000)
    for version in (2, 3):
        fmu = make_fmu(scene, tmp_path / f"fmi{version}.fmu", version=version)
        assert difference(fmu_rows(scene, fmu, 1000, FMU_EVERY), core, 3) == ""
    assert difference(node_rows(scene.with_run(duration_s=1.0), 1000, NODE_EVERY), core, 3) == ""


def test_inputs_that_vary_within_a_step_give_the_same_bits_too(tmp_path):
    path = tmp_path / "scene.toml"
    text = read_scene("robotino2").path.read_text()
    sine = '[[input]]\nsignal = "voltage_V[2]"\nkind = "sine"\namplitude = 2.0\nfrequency_Hz = 3.0\n\n[run]'
    path.write_text(text.replace("[run]", sine))
    scene = read_scene(path).with_run(duration_s=1.0)
    sampled, held = core_rows(scene, 1000), core_rows(scene, 1000, hold=True)
    assert difference(held, sampled, 3) != ""
    assert difference(node_rows(scene, 1000, NODE_EVERY), sampled, 3) == ""
    for version in (2, 3):
        fmu = make_fmu(scene, tmp_path / f"fmi{version}.fmu", version=version)
        assert difference(fmu_rows(scene, fmu, 1000, FMU_EVERY), held, 3) == ""


def test_one_bit_is_enough_to_be_noticed():
    scene = read_scene("s1")
    core = core_rows(scene, 50)
    rows = core.rows.copy()
    rows[29, 4] = np.nextafter(rows[29, 4], 1.0)
    words = difference(Rows("other", core.ticks, rows), core, 3)
    assert "1 of 600 numbers" in words
    assert "y_m after step 30" in words


def test_minus_zero_is_not_zero_and_a_missing_step_is_noticed():
    scene = read_scene("s1")
    core = core_rows(scene, 4, every=2)
    zeros, minus = np.zeros_like(core.rows), -np.zeros_like(core.rows)
    assert "differs" in difference(Rows("other", core.ticks, minus), Rows("core", core.ticks, zeros), 3)
    assert "stops at steps" in difference(Rows("other", core.ticks + 1, core.rows), core, 3)
    assert "gives" in difference(Rows("other", core.ticks, core.rows[:, :-1]), core, 3)


def test_exchanges_never_straddle_a_change_of_the_inputs():
    inputs = read_scene("s1").inputs_on_grid()
    windows = list(exchanges(inputs, 10_000, 7))
    assert sum(count for _, count in windows) == 10_000
    assert max(count for _, count in windows) == 7
    starts = {first for first, _ in windows}
    assert set(inputs.changes) <= starts


# ---- An FMU driven by FMPy has its library closed once: closed twice, the loader writes into memory that was
# freed.

@pytest.fixture
def closed(monkeypatch) -> list[int]:
    """The handles of the libraries that FMPy has closed."""
    handles: list[int] = []
    monkeypatch.setattr(fmpy.fmi1, "freeLibrary", handles.append)
    return handles


@pytest.fixture(params=[2, 3])
def fmu(request, tmp_path):
    return make_fmu(scene(), tmp_path / "scene.fmu", version=request.param)


def scene() -> Scene:
    return read_scene("s1")


def test_a_run_closes_the_fmus_library_once(fmu, closed):
    fmu_rows(scene(), fmu, 3)
    assert len(closed) == 1


def test_a_run_that_fails_closes_the_fmus_library_once(fmu, closed):
    def interrupt(_: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fmu_rows(scene(), fmu, 3, moved=interrupt)
    assert len(closed) == 1
