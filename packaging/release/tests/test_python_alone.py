"""A new user with Python and nothing else: the wheel of the release that fits this machine, in an empty environment."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from fresh_environment import Environment, fresh_environment
from packaging.tags import sys_tags
from packaging.utils import parse_wheel_filename
from release_folder import DIST

END_VALUES = ("x_m", "y_m", "heading_rad")


def wheel_for_this_machine() -> Path:
    """The one that pip would choose."""
    fits = list(sys_tags())
    found = [path for path in DIST.glob("*.whl") if parse_wheel_filename(path.name)[3] & set(fits)]
    if not found:
        pytest.skip(f"no wheel of the release is for this machine ({fits[0]})")
    return found[0]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Environment:
    return fresh_environment(tmp_path_factory.mktemp("empty"), wheel_for_this_machine(), ("rig",))


def test_a_robot_is_simulated_and_drawn(installed: Environment) -> None:
    installed.run("laconic", "simulate", "robotino2", "--plot", "p.png")
    assert (installed.folder / "p.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("version", ["2", "3"])
def test_its_fmu_ends_in_fmpy_where_the_wheels_own_run_ends(installed: Environment, version: str) -> None:
    from fmpy import simulate_fmu

    scene = "paper_three_wheel_free"
    installed.run("laconic", "fmu", scene, "--fmi", version, "-o", f"free{version}.fmu")
    found = json.loads(installed.run("laconic", "simulate", scene, "--json").stdout)["final"]
    result = simulate_fmu(str(installed.folder / f"free{version}.fmu"), output=list(END_VALUES))
    assert [result[-1][name] for name in END_VALUES] == [found[name] for name in END_VALUES]


def test_its_fmu_for_a_bus_is_valid_and_has_a_terminal(installed: Environment) -> None:
    from fmpy import read_model_description
    from fmpy.validation import validate_fmu

    installed.run("laconic", "fmu", "robotino2", "--fmi", "3", "--bus", "can", "-o", "bus.fmu")
    fmu = str(installed.folder / "bus.fmu")
    assert validate_fmu(fmu) == []
    assert "CAN.Tx_Data" in {each.name for each in read_model_description(fmu).modelVariables}


@pytest.mark.parametrize("board", ["virtual", "process"])
def test_a_node_is_driven(installed: Environment, board: str) -> None:
    answer = json.loads(installed.run("laconic", "rig", "s1", "--board", board, "--steps", "200", "--json").stdout)
    assert all(each["passed"] for each in answer["verdicts"])
