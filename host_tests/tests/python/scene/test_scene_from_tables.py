"""laconic.build_scene: a scene from a program's tables is the one that a file with them has."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import laconic
from laconic.base.paths import SCENE_DIR

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


def tables_of(name):
    return tomllib.loads((SCENE_DIR / f"{name}.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", ["s1", "kuka_youbot", "skid_steer"])
def test_the_tables_of_a_file_make_the_run_of_the_file(name):
    built = laconic.build_scene(tables_of(name)).with_run(duration_s=0.5)
    read = laconic.read_scene(name).with_run(duration_s=0.5)
    ours, theirs = laconic.simulate(built), laconic.simulate(read)
    assert list(ours.columns) == list(theirs.columns)
    assert all(ours.columns[key].tobytes() == theirs.columns[key].tobytes() for key in theirs.columns)


def test_arrays_stand_for_lists_and_numpys_numbers_for_numbers():
    tables = tables_of("s1")
    tables["run"]["duration_s"] = np.float64(0.25)
    tables["input"] = [{"signal": "voltage_V[1]", "kind": "steps", "t_s": np.array([0.0]), "value": np.array([3.0])}]
    scene = laconic.build_scene(tables)
    assert scene.run.duration_s == 0.25
    assert laconic.simulate(scene, ("voltage_V[1]",)).columns["voltage_V[1]"][0] == 3.0


@pytest.mark.parametrize("change, message", [
    ({"vehicle": {}}, "^Robot: vehicle.mass_kg: is missing"),
    ({"run": {"duration_s": -1.0, "step_s": 0.01}}, "^Robot: run.duration_s: "),
    ({"vehicles": {}}, "^Robot: vehicles: is no known key here; did you mean vehicle"),
    ({"vehicle": 3}, "^Robot: vehicle: is 3, not ")])
def test_what_makes_no_scene_is_refused_by_its_key(change, message):
    with pytest.raises(laconic.BadInput, match=message):
        laconic.build_scene({**tables_of("s1"), "name": "Robot", **change})


def test_what_is_no_mapping_is_refused():
    with pytest.raises(laconic.BadInput, match="scene: 's1' is no mapping"):
        laconic.build_scene("s1")


def test_a_name_that_fills_a_page_is_refused_by_its_length() -> None:
    tables = {"name": "n" * 10**6, "vehicle": {"mass_kg": 1.0}, "run": {"duration_s": 1.0, "step_s": 0.1}}
    with pytest.raises(laconic.BadInput) as refused:
        laconic.build_scene(tables)
    assert str(refused.value).endswith("name: has 1000000 letters; give at most 255, and what else there is to say as "
                                       "source")
