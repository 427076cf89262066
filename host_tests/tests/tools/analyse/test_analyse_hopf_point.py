"""A scene that stands at a bifurcation, or a little beside it, is reported as it is and never "not confirmed"."""

import numpy as np
import pytest

from laconic.scene import read_scene
from laconic.tools.analyse.continuation import diagram
from laconic.tools.analyse.findings import StudyOptions
from laconic.tools.analyse.from_core import subject_of
from laconic.tools.analyse.motions import command_parameter
from laconic.tools.analyse.study import study


@pytest.fixture(scope="module")
def subject():
    return subject_of(read_scene("paper_three_wheel_hopf"))


@pytest.fixture(scope="module")
def hopf(subject) -> float:
    parameter = command_parameter(subject, "nu2", np.array([0.0, 112.5, 0.0]))
    return float(diagram(parameter.field_of, 115.0, 121.0, grid=5).hopf[0].parameter)


def at(subject, command):
    return study(subject, StudyOptions(("steady", "bifurcation"), straight=(0.0, command)), lambda *_: None)


@pytest.mark.parametrize("beside", [0.0, -1e-6, 1e-6, -1e-4, 1e-4])
def test_a_scene_at_a_hopf_point_or_a_little_beside_it_is_not_a_failure(subject, hopf, beside):
    assert at(subject, hopf * (1.0 + beside)).failures == []


def test_a_scene_at_a_hopf_point_is_reported_and_gets_no_cycle_without_size(subject, hopf):
    found = at(subject, hopf)
    assert any("stands at the Andronov–Hopf point" in words for words in found.words["bifurcation"])
    assert all(abs(item.cycle.parameter - hopf) > 1.0 for item in found.bifurcation.cycles)


def test_a_scene_well_beside_a_hopf_point_still_gets_its_own_cycle_simulated(subject, hopf):
    found = at(subject, 0.99 * hopf)
    (own, *_) = [item for item in found.bifurcation.cycles if abs(item.cycle.parameter - 0.99 * hopf) < 1e-9]
    assert own.confirmation.simulated
    assert "started at 0.9" in own.confirmation.words
    assert not any("stands at" in words for words in found.words["bifurcation"])


@pytest.mark.parametrize("beside", [0.0, -1e-6, 1e-5])
def test_a_scene_at_the_threshold_of_straight_motion_is_not_a_failure(subject, beside):
    assert at(subject, 1.6 * (1.0 + beside)).failures == []
