"""Motions with a closed form, of `laconic soak long`: the closed forms themselves, and that nothing drifts."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
from mpmath import mp, mpf

from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.soak import StoppedEarly
from laconic.soak import long as soak_long
from laconic.soak._long.cases import CASES, digits, prepared
from laconic.soak._long.closed_form import along
from laconic.soak._long.run import LongRun, as_double

STEPS = 20_000


@pytest.mark.parametrize("case", [case for case in CASES if case.nu[2]], ids=lambda case: case.name)
def test_the_closed_form_is_the_motion_that_collocation_gives(case):
    with digits():
        each = prepared(case, as_double)
        time_s = mpf("7.3") if case.steady else each.motion.period_s * mpf("1.37")
        truth = each.motion.at(Fraction(mp.nstr(time_s, 50)))
        nu, shift, turned = along(each.motion.model, each.motion.nu, each.held, mpf(mp.nstr(time_s, 50)))
        place = each.motion.place + shift * mp.expj(each.motion.heading)
        assert abs(place - truth.place) < mpf("1e-22")
        assert abs(each.motion.heading + turned - truth.heading) < mpf("1e-22")
        assert max(abs(p - q) for p, q in zip(nu, truth.nu, strict=True)) < mpf("1e-22")


def test_nothing_drifts_in_either_scalar_type(tmp_path):
    result = soak_long.soak(1.0, 1, lambda _: None, steps=STEPS, out=tmp_path)
    assert result["passed"], result["drifted"]
    rows = json.loads((tmp_path / "auto-double.json").read_text())["rows"]
    assert {row["case"] for row in rows} == {case.name for case in CASES}
    assert {row["steps"] for row in rows} == {1000, 10_000, STEPS}
    rest = [row for row in rows if row["case"] == "rest"]
    assert all(row["place_error_m"] == 0.0 for row in rest)
    assert "circle, damping × 1000, rk4, double" not in result  # beyond the step that rk4 takes


def test_a_vehicle_that_is_off_by_a_millionth_is_found(tmp_path, monkeypatch):
    right = soak_long.LongRun

    def slower(*given: object) -> LongRun:
        made = right(*given)  # type: ignore[arg-type]
        for lane, each in enumerate(made.cases):
            made.batch.start(lane, nu_rad_per_s=[x * (1 - 1e-6) for x in each.nu], x_m=100.0, y_m=-50.0,
                             heading_rad=2.0)
        return made

    monkeypatch.setattr(soak_long, "LongRun", slower)
    result = soak_long.soak(1.0, 1, lambda _: None, steps=STEPS, method="auto", out=tmp_path)
    assert not result["passed"]
    assert "spin, free, auto, double" in result["drifted"]


def test_a_run_that_was_ended_goes_on_with_the_same_bits(tmp_path):
    def advance(amount: float) -> None:
        if amount > 0:
            raise KeyboardInterrupt

    with pytest.raises(StoppedEarly):
        soak_long.soak(1.0, 1, advance, steps=STEPS, method="rk4", out=tmp_path / "ended")
    assert json.loads((tmp_path / "ended/rk4-double.json").read_text())["done"] == 1000
    for folder in ("ended", "whole"):
        soak_long.soak(1.0, 1, lambda _: None, steps=STEPS, method="rk4", out=tmp_path / folder)
    for name in ("rk4-double.json", "rk4-single.json"):
        assert (tmp_path / "ended" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


@pytest.mark.parametrize("content, told", [
    ("[3]", "is no file of a long run"),
    ('{"about": {}, "done": 3, "rows": [], "states": []}', "another core or other cases")])
def test_a_file_of_something_else_is_refused(content, told, tmp_path):
    (tmp_path / "rk4-double.json").write_text(content)
    with pytest.raises(BadInput, match=told):
        soak_long.soak(1.0, 1, lambda _: None, steps=1000, method="rk4", out=tmp_path)


@pytest.mark.parametrize("words, told", [("--steps 0", "--steps"), ("--method rk5", "did you mean rk4?"),
                                         ("--vehicles 3", "has no effect on soak long")])
def test_wrong_options_are_one_line(words, told, capsys):
    assert run(["soak", "long", *words.split()]) == 2
    err = capsys.readouterr().err
    assert told in err
    assert err.count("\n") == 1
