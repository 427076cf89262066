"""`laconic verify`: the core agrees with reference trajectories of 25 digits, and a fault is reported."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

from laconic.cli.main import run
from laconic.scene.methods import EXACT, EXACT_4, EXPLICIT, EXPLICIT_8, STIFF, STIFF_4
from laconic.tools.verify.trajectories import step_that_fits

DATA = Path(__file__).parents[2] / "data"
TRAJECTORIES, METHODS = DATA / "trajectories.json", DATA / "methods.json"
ERRORS = ("error_nu", "error_pose", "error_wheel")


def verify(capsys, *arguments: object) -> tuple[int, dict]:
    """Exit status and parsed answer."""
    status = run(["verify", *map(str, arguments), "--json"])
    return status, json.loads(capsys.readouterr().out)


def worst(case: dict) -> float:
    return max(case[key] for key in ERRORS)


def by_name(answer: dict) -> dict[str, dict]:
    return {case["name"]: case for case in answer["cases"]}


def test_rk4_at_1_ms_is_within_1e_10_everywhere_but_in_the_stiff_case(capsys):
    status, answer = verify(capsys, TRAJECTORIES, "--method", EXPLICIT, "--step", "1e-3")
    assert status == 1
    assert (answer["method"], answer["step_s"], answer["real"]) == (EXPLICIT, 1e-3, "double")
    assert len(answer["cases"]) == 12
    for name, case in by_name(answer).items():
        if name != "omni3-stiff":
            assert case["status"] == "ok"
            assert worst(case) < 1e-10, case
            assert case["seconds"] > 0.0


def test_taylor_8_at_10_ms_is_within_1e_12_everywhere_but_in_the_stiff_case(capsys):
    status, answer = verify(capsys, TRAJECTORIES, "--method", EXPLICIT_8, "--step", 0.01)
    assert status == 1
    cases = by_name(answer)
    assert cases.pop("omni3-stiff")["status"].startswith("step beyond damping limit")
    assert max(worst(case) for case in cases.values()) < 1e-12


def test_the_stiff_case_is_refused_with_the_largest_stable_step_and_runs_with_it(capsys):
    _, answer = verify(capsys, TRAJECTORIES, "--method", EXPLICIT, "--step", "1e-3")
    stiff = by_name(answer)["omni3-stiff"]
    assert [stiff[key] for key in ERRORS] == [None, None, None]
    assert stiff["status"].startswith("step beyond damping limit")
    largest = float(re.search(r"at most ([0-9.e-]+) s", stiff["status"])[1])
    _, within = verify(capsys, TRAJECTORIES, "--method", EXPLICIT, "--step", 0.999 * largest)
    assert by_name(within)["omni3-stiff"]["status"] == "ok"
    _, beyond = verify(capsys, TRAJECTORIES, "--method", EXPLICIT, "--step", 0.1 / math.ceil(0.1 / largest - 1))
    assert by_name(beyond)["omni3-stiff"]["status"] != "ok"


@pytest.mark.parametrize("method", ["auto", STIFF_4, EXACT_4])
def test_fourth_order_methods_take_every_case(method, capsys):
    status, answer = verify(capsys, TRAJECTORIES, "--method", method, "--tolerance", "1e-7")
    assert status == 0
    non_stiff = [worst(case) for name, case in by_name(answer).items() if name != "omni3-stiff"]
    assert max(non_stiff) < 1e-10


@pytest.mark.parametrize("method", [STIFF, EXACT])
def test_second_order_methods_take_every_case(method, capsys):
    status, _ = verify(capsys, TRAJECTORIES, "--method", method, "--tolerance", "1e-5")
    assert status == 0


@pytest.mark.parametrize(("method", "order"), [(EXPLICIT, 4), (STIFF, 2), (STIFF_4, 4),
                                               (EXACT, 2), (EXACT_4, 4), (EXPLICIT_8, 8)])
def test_errors_shrink_with_the_order_of_the_method(method, order, capsys):
    coarse = by_name(verify(capsys, TRAJECTORIES, "--method", method, "--step", 0.025)[1])
    fine = by_name(verify(capsys, TRAJECTORIES, "--method", method, "--step", 0.0125)[1])
    ratio = worst(coarse["differential-drive"]) / worst(fine["differential-drive"])
    assert abs(math.log2(ratio) - order) < 0.2


def test_auto_takes_the_damping_series_at_10_ms(capsys):
    status, answer = verify(capsys, METHODS, "--method", "auto", "--step", 0.01, "--tolerance", "1e-3")
    assert status == 0
    assert len(answer["cases"]) == 8
    assert max(case["error_nu"] for case in answer["cases"]) < 2e-6


def test_single_precision_keeps_single_digits(capsys):
    status, answer = verify(capsys, TRAJECTORIES, "--real", "single", "--step", 0.01, "--tolerance", "1e-4")
    assert status == 0
    assert answer["real"] == "single"
    assert worst(by_name(answer)["omni6"]) > 1e-9


def test_over_the_tolerance_is_exit_status_1(capsys):
    assert verify(capsys, TRAJECTORIES, "--method", "auto", "--tolerance", "1e-18")[0] == 1
    assert verify(capsys, TRAJECTORIES, "--method", "auto")[0] == 0


@pytest.mark.parametrize("key", ["nu", "pose", "chi"])
def test_a_reference_that_is_wrong_in_one_number_is_noticed(key, tmp_path, capsys):
    content = json.loads(TRAJECTORIES.read_text())
    case = next(case for case in content["cases"] if case["name"] == "mecanum4")
    state = case["states"][3][key]
    state[1] = str(float(state[1]) + 1e-6)
    path = tmp_path / "wrong.json"
    path.write_text(json.dumps(content))
    status, answer = verify(capsys, path, "--tolerance", "1e-9")
    assert status == 1
    over = {name for name, case in by_name(answer).items() if worst(case) > 1e-9 and name != "omni3-stiff"}
    assert over == {"mecanum4"}


@pytest.mark.parametrize(("duration", "step", "steps", "fitting"), [
    (0.5, 0.1, 5, 0.1), (0.5, 0.2, 3, 0.5 / 3), (0.25, 1.0, 1, 0.25), (0.3, 0.1, 3, 0.1), (1.0, 1e-3, 1000, 1e-3)])
def test_a_step_that_does_not_divide_a_segment_is_shortened_to_the_next_that_does(duration, step, steps, fitting):
    assert step_that_fits(duration, step) == (steps, fitting)


def test_the_table_for_people_names_every_case(capsys):
    assert run(["verify", str(TRAJECTORIES), "--method", EXPLICIT]) == 1
    text = capsys.readouterr().out
    for case in json.loads(TRAJECTORIES.read_text())["cases"]:
        assert case["name"] in text
    assert "step beyond damping limit" in text


def bad_reference(change) -> str:
    content = json.loads(TRAJECTORIES.read_text())
    change(content)
    return json.dumps(content)


@pytest.mark.parametrize(("text", "word"), [
    ("{", "JSON"), ("[]", "cases"), ('{"format": 1, "cases": []}', "nothing to compare"),
    ('{"cases": []}', "format"), ('{"format": 2, "cases": []}', "format 1"),
    (bad_reference(lambda c: c["cases"][0]["vehicle"].pop("M")), "cases[1].vehicle.M"),
    (bad_reference(lambda c: c["cases"][1]["states"].pop()), "cases[2].states"),
    (bad_reference(lambda c: c["cases"][0].update(segments=[], states=[])), "cases[1].segments"),
    (bad_reference(lambda c: c["cases"][0]["segments"][0].update(duration=-1)), "cases[1].segments[1].duration"),
    (bad_reference(lambda c: c["cases"][0]["segments"][0].update(duration=1e300)), "cases[1].segments[1].duration"),
    (bad_reference(lambda c: c["cases"][0]["segments"][0].update(U=[1, 2, 3])), "cases[1].segments[1].U"),
    (bad_reference(lambda c: c["cases"][0]["vehicle"].update(locked=[1])), "cases[1].vehicle.locked"),
    (bad_reference(lambda c: c["cases"][2]["states"][0]["nu"].__setitem__(1, "x")), "cases[3].states[1].nu"),
    (bad_reference(lambda c: c["cases"][0]["vehicle"]["wheels"][0].pop("beta")), "vehicle.wheels[1].beta")])
def test_a_file_that_is_no_reference_is_one_line_and_status_2(text, word, tmp_path, capsys):
    path = tmp_path / "reference.json"
    path.write_text(text)
    assert run(["verify", str(path)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert str(path) in captured.err
    assert word in captured.err


@pytest.mark.parametrize("option", ["--step", "--tolerance"])
@pytest.mark.parametrize("value", ["0", "-1", "nan"])
def test_numbers_that_are_not_above_zero_are_refused(option, value, capsys):
    assert run(["verify", str(TRAJECTORIES), option, value]) == 2
    assert option in capsys.readouterr().err
