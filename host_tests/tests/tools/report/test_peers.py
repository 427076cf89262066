"""Other integrators, where they are installed, agree with the core: so both sides of a comparison are right."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.report import peers
from laconic.tools.report.accuracy import Truth, follow
from laconic.tools.report.workshop import HOST
from laconic.tools.verify.reference import reference_states

pytestmark = pytest.mark.skipif(not HOST.present, reason="no gcc here")
MISSING = peers.missing_peers()


@pytest.fixture(scope="module")
def scene() -> Scene:
    return read_scene("s1").with_run(step_s=0.01, duration_s=3.0)


@pytest.fixture(scope="module")
def truth(scene: Scene) -> Truth:
    ends = np.cumsum(peers.course_of(scene).durations_s)
    return Truth(ends, reference_states(scene, ends))


@pytest.mark.skipif("casadi" in MISSING, reason="CasADi is not installed")
def test_casadis_rk4_and_ours_take_the_same_velocities_to_rounding(scene: Scene, tmp_path: Path):
    casadi = peers.CasadiRk4(peers.course_of(scene), 100, tmp_path)
    ours = follow(scene.with_run(method=EXPLICIT), "double", np.array([1.7]))[0]
    np.testing.assert_allclose(ours[:3], casadi.state_after(170)[:3], rtol=1e-12, atol=1e-13)


@pytest.mark.skipif(any("CVODE" in name for name in MISSING), reason="SUNDIALS CVODE is not installed")
@pytest.mark.parametrize("bdf", [False, True], ids=["Adams", "BDF"])
def test_cvode_from_c_reaches_the_reference(scene: Scene, truth: Truth, tmp_path: Path, bdf: bool):
    states = peers.cvode_runner(peers.course_of(scene), tmp_path)(bdf, 1e-9).states
    assert np.max(np.abs(states - truth.states)) < 1e-5


@pytest.mark.skipif("numbalsoda" in MISSING, reason="numbalsoda is not installed")
@pytest.mark.parametrize("compiled_rhs", [True, False], ids=["C", "numba"])
def test_compiled_dop853_reaches_the_reference(scene: Scene, truth: Truth, tmp_path: Path, compiled_rhs: bool):
    states = peers.dop853_runner(peers.course_of(scene), tmp_path, compiled_rhs)(1e-9).states
    assert np.max(np.abs(states - truth.states)) < 1e-7


@pytest.mark.parametrize("solver", ["DOP853", "Radau"])
def test_scipy_reaches_the_reference(scene: Scene, truth: Truth, solver: str):
    states = peers.scipy_runner(peers.course_of(scene), solver)(1e-7).states
    assert np.max(np.abs(states - truth.states)) < 1e-5


def test_a_course_holds_the_scenes_voltages(scene: Scene):
    course = peers.course_of(scene)
    assert course.durations_s.tolist() == pytest.approx([0.5] * 6)
    assert course.voltages_V[1].tolist() == [-2.0, 2.0, -1.0]
