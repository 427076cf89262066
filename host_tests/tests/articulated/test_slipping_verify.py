"""`laconic verify` of references of vehicles with hinges on ground with friction."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from laconic.cli.commands.verify import command
from laconic.errors import BadInput

REFERENCE = Path(__file__).parents[1] / "data" / "articulated_friction_reference.json"
CASES: list[dict[str, Any]] = json.loads(REFERENCE.read_text(encoding="utf-8"))


def verified(path: Path, *options: str) -> dict[str, dict[str, Any]]:
    """The results by name."""
    result = CliRunner().invoke(command, [str(path), "--json", *options], standalone_mode=False)
    if result.exception:
        raise result.exception
    return {each["name"]: each for each in json.loads(result.stdout)["cases"]}


def errors(found: dict[str, Any]) -> list[float]:
    return [found["error_pose"], found["error_nu"], found["error_wheel"]]


def test_trajectories_are_within_twice_the_listed_errors_and_halve_with_the_step() -> None:
    coarse, fine = verified(REFERENCE, "--step", "0.001"), verified(REFERENCE, "--step", "0.0005")
    for case in (each for each in CASES if "segments" in each):
        listed = case["prototype_error_by_step_s"]["0.001"]
        assert coarse[case["name"]]["prototype_error"] == listed
        for found, halved, limit in zip(errors(coarse[case["name"]]), errors(fine[case["name"]]), listed, strict=True):
            assert found <= 2.0 * limit and 1.7 <= found / halved <= 2.3


def test_single_steps_keep_their_own_size_and_reach_their_bars() -> None:
    found = verified(REFERENCE, "--step", "0.02")["one_step"]
    assert found["error_energy_norm"] <= 1e-9 and found["error_hinge_rate"] <= 1e-8 and found["error_pose"] is None


def test_a_tolerance_decides_the_exit_status_and_single_precision_runs() -> None:
    run = CliRunner()
    for tolerance, status in (("1", 0), ("1e-6", 1)):
        given = [str(REFERENCE), "--tolerance", tolerance, "--real", "single"]
        assert run.invoke(command, given, standalone_mode=False).return_value == status


def broken(**changes: Any) -> list[dict[str, Any]]:
    case = copy.deepcopy(CASES[0])
    for path, value in changes.items():
        *above, key = path.split("__")
        target: Any = case
        for name in above:
            target = target[int(name)] if name.isdecimal() else target[name]
        target[key] = value
    return [case]


@pytest.mark.parametrize(("cases", "words"), [
    (broken(vehicle__bodies__1__parent=3), ("bodies[2].parent", "is 3")),
    (broken(vehicle__bodies__1__mass_kg="x"), ("bodies[2].mass_kg",)),
    (broken(vehicle__wheels__0__body=9), ("wheels[1].body", "is 9")),
    (broken(vehicle__wheels=[]), ("vehicle.wheels", "none")),
    (broken(start__z=[0.0]), ("start.z",)),
    (broken(segments__0__duration_s=-1.0), ("segments[1].duration_s", "above 0")),
    (broken(segments__0__voltage_V=[1.0]), ("segments[1].voltage_V",)),
    (broken(expected__x_m=None), ("expected.x_m",)),
    ([{**CASES[-1], "steps": [{"vehicle": "nothing"}]}], ("nothing",)), ([], ("cases",))])
def test_a_broken_file_is_one_line_with_its_field(tmp_path: Path, cases: list[dict[str, Any]], words: tuple[str, ...]
                                                  ) -> None:
    path = tmp_path / "broken.json"
    path.write_text(json.dumps(cases), encoding="utf-8")
    with pytest.raises(BadInput) as why:
        verified(path)
    assert "\n" not in str(why.value) and all(word in str(why.value) for word in (str(path), *words)), why.value


def test_a_method_of_ideal_ground_is_refused() -> None:
    with pytest.raises(BadInput, match="circle does not step"):
        verified(REFERENCE, "--method", "circle")
