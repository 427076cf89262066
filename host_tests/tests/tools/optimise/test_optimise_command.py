"""`laconic optimise` as a user calls it: tables, files, pictures, JSON, Ctrl-C, and what it refuses."""

from __future__ import annotations

import json

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.scene import read_scene
from laconic.scene.scene_tables import scene_tables
from laconic.tools.optimise import search as search_room

CARRIAGE = "paper_three_wheel_driven"
ALONG_ETA = "straight_stable_speed_m_per_s(direction_deg=90)"
VERTEX = [CARRIAGE, "--free", "vehicle.wheel[3].distance_m=0.07:0.2", "--free", "vehicle.com_y_m=0:0.1",
          "--goal", f"max:{ALONG_ETA}", "--subject-to", "least_load_share>=0.1", "--generations", "60"]


def test_best_toml_is_the_scene_with_its_comments_and_the_numbers_found(tmp_path, capsys):
    out, plot = tmp_path / "best.toml", tmp_path / "vehicle.png"
    assert run(["optimise", *VERTEX, "-o", str(out), "--plot", str(plot)]) == 0
    printed = capsys.readouterr().out
    assert "| vehicle.com_y_m | 0.02 | 0.056 | 0 to 0.1 |" in printed
    assert "Active: least_load_share>=0.1" in printed and "distance_m is at its lower end" in printed
    text = out.read_text(encoding="utf-8")
    assert "# c1" in text and "# was 0.02; Δ R" in text and f"max:{ALONG_ETA}: 0.642857, was 0.15" in text
    assert read_scene(out).vehicle["com_y_m"] == pytest.approx(0.056, rel=1e-6)
    assert scene_tables(out).value("vehicle.wheel[3].distance_m") == pytest.approx(0.07, rel=1e-6)
    assert plot.stat().st_size > 10_000


def test_scene_whose_numbers_stand_elsewhere_is_written_anew(tmp_path):
    scene = tmp_path / "inline.toml"
    scene.write_text('vehicle = {mass_kg = 1.0, yaw_inertia_kgm2 = 0.1, wheel_radius_m = 0.1, wheel_inertia_kgm2 = 0, '
                     'wheel = [\n'
                     '{kind = "omni", x_m = 0.1, y_m = 0.0, axle_deg = 0}, {kind = "omni", x_m = 0, y_m = 0.1, '
                     'axle_deg = 90}, {kind = "omni", x_m = -0.1, y_m = 0, axle_deg = 180}]}\n'
                     "[run]\nduration_s = 1.0\nstep_s = 0.01\n", encoding="utf-8")
    out = tmp_path / "best.toml"
    assert run(["optimise", str(scene), "--free", "vehicle.wheel[2].y_m=0.05:0.2", "--free",
                "vehicle.com_x_m=0.01:0.02", "--goal", "max:farthest_wheel_m", "--goal", "min:condition",
                "--generations", "10", "--points", "2", "-o", str(out)]) == 0
    assert 0.01 <= read_scene(out).vehicle["com_x_m"] <= 0.02


def test_json_has_all_digits_and_pick_chooses_the_point_of_the_front(tmp_path, capsys):
    arguments = ["optimise", CARRIAGE, "--free", "vehicle.wheel[1].distance_m,vehicle.wheel[2].distance_m=0.07:0.15",
                 "--goal", f"max:{ALONG_ETA}", "--goal", "max:yaw_rate_rad_per_s_per_V", "--points", "2",
                 "--generations", "20", "--json", "--front", str(tmp_path / "front.png"), "--pick", "1"]
    assert run(arguments) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["front"][0]["free"] == [found["free"][0]["found"]] == [pytest.approx(0.15, rel=1e-6)]
    assert [entry["unit"] for entry in found["measures"]] == ["m/s", "rad/s/V"]
    speeds, yaws = np.array([point["measures"] for point in found["front"]]).T
    assert (np.diff(speeds) < 0.0).all() and (np.diff(yaws) > 0.0).all()
    assert speeds * yaws**2 == pytest.approx(speeds[0] * yaws[0] ** 2, rel=1e-6)  # σ² times σ⁻²
    assert (tmp_path / "front.png").stat().st_size > 10_000


def test_bounds_that_nothing_keeps_are_told_with_exit_status_1_and_no_file(tmp_path, capsys):
    assert run(["optimise", CARRIAGE, "--free", "vehicle.com_y_m=0:0.01", "--goal", "min:condition", "--subject-to",
                f"{ALONG_ETA}>=5", "--generations", "5", "-o", str(tmp_path / "best.toml")]) == 1
    assert not list(tmp_path.iterdir())
    assert "no choice within the ranges keeps all constraints" in capsys.readouterr().err


def test_ctrl_c_keeps_the_best_so_far_and_says_so(tmp_path, capsys, monkeypatch):
    whole = search_room.differential_evolution

    def stopped(*given, callback, **more):
        generations = iter(range(3))

        def after_three(*_, **__):
            if next(generations, None) is None:
                raise KeyboardInterrupt

        return whole(*given, callback=after_three, **more)

    monkeypatch.setattr(search_room, "differential_evolution", stopped)
    out = tmp_path / "best.toml"
    assert run(["optimise", *VERTEX, "-o", str(out)]) == 130
    printed = capsys.readouterr()
    assert "The search was stopped: this is the best of what it had found." in printed.out
    assert "stopped by the user" in printed.err
    assert read_scene(out).vehicle["com_y_m"] != 0.02


def test_goals_lists_every_measure_with_unit_and_arguments(capsys):
    assert run(["optimise", "--goals"]) == 0
    printed = capsys.readouterr().out
    assert "straight_stable_speed_m_per_s(direction_deg=…) [m/s]" in printed and "yaw_authority [–]" in printed


def test_vehicles_that_make_no_sense_are_passed_over(capsys):
    """A mass below 0 is refused by the core: half of the range has it, the choice has not."""
    assert run(["optimise", "kuka_youbot", "--free", "vehicle.mass_kg=-20:40", "--goal", "min:total_mass_kg", "--json",
                "--subject-to", "fastest_damping_per_s<=20"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert 0.0 < found["free"][0]["found"] < 40.0
    assert found["active"] == ["fastest_damping_per_s<=20"]


def test_scene_that_is_better_than_its_ranges_is_told(capsys):
    assert run(["optimise", CARRIAGE, "--free", "vehicle.com_y_m=0:0.01", "--goal", f"max:{ALONG_ETA}",
                "--generations", "5"]) == 0
    assert "its own numbers lie outside the ranges" in capsys.readouterr().out


def test_goal_that_is_infinite_beside_another_and_a_point_that_the_front_has_not_are_refused(capsys):
    """With the mass beyond the third wheel straight motion is stable at every speed."""
    options = ["--free", "vehicle.com_y_m=0.05:0.1", "--goal", f"max:{ALONG_ETA}", "--goal", "min:condition",
               "--generations", "5"]
    assert run(["optimise", CARRIAGE, *options]) == 2
    assert f"--subject-to '{ALONG_ETA}>=…'" in capsys.readouterr().err
    options[1] = "vehicle.com_y_m=0.01:0.05"
    assert run(["optimise", CARRIAGE, *options, "--points", "2", "--pick", "90"]) == 2
    assert "--pick 90: the front has" in capsys.readouterr().err


@pytest.mark.parametrize(("options", "words"), [
    ("", "--free: is missing"), ("--free vehicle.com_y_m=0:1", "--goal: is missing"),
    ("--free vehicle.com_y_m --goal min:condition", "--free vehicle.com_y_m: is no range"),
    ("--free vehicle.com_y_m=1:0 --goal min:condition", "the range is empty"),
    ("--free vehicle.com_y_m=0:nan --goal min:condition", "nan is no finite number"),
    ("--free vehicle.comy_m=0:1 --goal min:condition", "did you mean com_y_m?"),
    ("--free vehicle.wheel[9].x_m=0:1 --goal min:condition", "there is no vehicle.wheel[9]"),
    ("--free vehicle.wheel[*].bearing_deg=0:1 --goal min:condition", "no single value"),
    ("--free vehicle.wheel[1].kind=0:1 --goal min:condition", "is text, which has no range"),
    ("--free vehicle.com_y_m=0:1 --free vehicle.com_y_m=0:2 --goal min:condition", "names, too; keep one of them"),
    ("--free vehicle.com_y_m=0:1 --goal condition", "give min:condition or max:condition"),
    ("--free vehicle.com_y_m=0:1 --goal min:conditio", "did you mean condition?"),
    ("--free vehicle.com_y_m=0:1 --goal min:straight_growth_per_s", "speed_m_per_s is missing"),
    ("--free vehicle.com_y_m=0:1 --goal min:condition --subject-to condition", "is no bound"),
    ("--free vehicle.com_y_m=0:1 --goal min:condition --subject-to condition<=x", "x is no finite number"),
    ("--free vehicle.com_y_m=0:1 --goal min:grip_margin_N(acceleration_m_per_s2=1,direction_deg=0)",
     "vehicle.friction_coefficient"),
    ("--free vehicle.com_y_m=0:1 --goal min:condition --front f.png", "several goals alone"),
    ("--free vehicle.com_y_m=0:1 --goal min:condition --pick 2", "several goals alone"),
    ("--free vehicle.com_y_m=0:1 --goal min:condition --points 1", "--points"),
    ("--free vehicle.com_y_m=0:1 --goal min:condition -o best.png", "ends in .toml")])
def test_options_that_do_not_fit_are_refused_in_one_line(options, words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["optimise", CARRIAGE, *options.split()]) == 2
    told = capsys.readouterr().err
    assert words in told and told.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
