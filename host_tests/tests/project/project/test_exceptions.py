"""Every exception of the package goes to other processes and back, and its message is one bounded line."""

from __future__ import annotations

import copy
import importlib
import inspect
import multiprocessing
import pickle
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import laconic
from laconic.errors import LONGEST_LINE, LaconicError, words_of

CAN_FORK = "fork" in multiprocessing.get_all_start_methods()
VALUES = {"str": "words", "int": 2, "float": 2.5}


def kinds_of_errors() -> list[type[BaseException]]:
    """Every class of exceptions in a module of the package that can be imported here."""
    found: dict[str, type[BaseException]] = {}
    folder = Path(laconic.__path__[0])
    for path in sorted(folder.rglob("*.py")):
        name = ".".join(("laconic", *path.relative_to(folder).with_suffix("").parts)).removesuffix(".__init__")
        if name.endswith("__main__"):
            continue
        try:
            room = importlib.import_module(name)
        except ImportError:  # an extra that is not installed
            continue
        for each in vars(room).values():
            if isinstance(each, type) and issubclass(each, BaseException) and each.__module__.startswith("laconic."):
                found[f"{each.__module__}.{each.__qualname__}"] = each
    return [found[name] for name in sorted(found)]


def made(kind: type[BaseException]) -> BaseException:
    """An exception of the class, with arguments of the types that its constructor names."""
    if kind is laconic.RunRefused:
        return refused_run()
    wanted = inspect.signature(kind.__init__).parameters.values()
    plain = [each for each in wanted if each.name != "self" and each.kind is each.POSITIONAL_OR_KEYWORD]
    return kind(*(VALUES[each.annotation] for each in plain)) if plain else kind("words")


def refused_run() -> laconic.RunRefused:
    tables = {"vehicle": {"mass_kg": 1.0, "yaw_inertia_kgm2": 0.1, "wheel_radius_m": 0.05},
              "initial": {"yaw_rate_rad_per_s": 1.0},
              "input": [{"signal": "body_moment_Nm", "kind": "steps", "t_s": [0.0, 0.5], "value": [0.0, 1e308]}],
              "run": {"duration_s": 2.0, "step_s": 0.1}}
    with pytest.raises(laconic.RunRefused) as refused:
        laconic.simulate(laconic.build_scene(tables))
    return refused.value


KINDS = kinds_of_errors()


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__qualname__)
def test_an_exception_is_the_same_after_copy_and_pickle(kind: type[BaseException]) -> None:
    error = made(kind)
    for other in (copy.copy(error), copy.deepcopy(error), pickle.loads(pickle.dumps(error))):
        assert type(other) is kind and other.args == error.args and str(other) == str(error)
        assert other.__dict__.keys() == error.__dict__.keys()
        for name, value in error.__dict__.items():
            assert name == "run" or getattr(other, name) == value


def test_the_classes_that_are_tested_are_those_that_users_meet() -> None:
    names = {kind.__qualname__ for kind in KINDS}
    assert {"BadInput", "Refused", "RunRefused", "ResultFails", "CannotReach", "NodeSilent", "NodeRefused", "BusDied",
            "Interrupted", "Ended", "Unanswered"} <= names


def test_a_refused_run_takes_its_motion_along() -> None:
    error = refused_run()
    other = pickle.loads(pickle.dumps(error))
    assert (other.status, other.field, other.item, other.value, other.limit, other.exit_status) == (
        error.status, error.field, error.item, error.value, error.limit, error.exit_status)
    assert other.run.time_s.tolist() == error.run.time_s.tolist()
    assert other.run.columns["x_m"].tolist() == error.run.columns["x_m"].tolist()


def driven(volts: float) -> float:
    plant = laconic.Vehicle.of(laconic.read_scene("robotino2")).plant(step_s=0.01)
    plant.run({"voltage_V": [volts, 0.0, 0.0]})
    return plant.pose.x_m


@pytest.mark.skipif(not CAN_FORK, reason="this system cannot fork")
def test_a_pool_answers_with_the_refusal_of_a_step() -> None:
    context = multiprocessing.get_context("fork")
    with context.Pool(1) as pool, pytest.raises(laconic.Refused, match=r"voltage_V\[1\]: NaN is not a finite") as first:
        pool.map_async(driven, [1.0, float("nan")]).get(60)
    with ProcessPoolExecutor(1, mp_context=context) as workers, pytest.raises(laconic.Refused) as second:
        list(workers.map(driven, [1.0, float("nan")]))
    for refused in (first.value, second.value):
        assert (refused.status, refused.field, refused.item) == ("not finite", "voltage_V", 1)


def lines() -> Iterator[tuple[Any, str]]:
    many = "x" * 10**6
    yield laconic.BadInput(f"{many}: is no key"), f"{many[:60]}…: is no key"
    yield laconic.BadInput(f"scene.toml: {many}, {many}: twice"), f"scene.toml: {many[:60]}…, {many[:60]}…: twice"
    yield laconic.BadInput(f"folder/{many}/a: no file"), f"folder/{many[:60]}…/a: no file"
    yield laconic.BadInput("is\n  two lines"), "is two lines"


@pytest.mark.parametrize("error, message", list(lines()))
def test_a_name_of_a_million_letters_is_shortened_in_every_message(error: LaconicError, message: str) -> None:
    assert str(error) == message


def test_a_message_of_a_million_words_is_shortened() -> None:
    text = str(laconic.BadInput("word " * 10**6))
    assert len(text) < LONGEST_LINE and " … " in text


def test_the_name_of_a_file_stays_whole(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    name = "n" * 200 + ".toml"
    (tmp_path / name).touch()
    assert str(laconic.BadInput(f"{name}: no scene")) == f"{name}: no scene"
    assert str(laconic.BadInput(f"{tmp_path}/{name}: no scene")) == f"{tmp_path}/{name}: no scene"


@pytest.mark.parametrize("error, words", [
    (FileNotFoundError(2, "No such file or directory", "a.log"), "no such file or directory"),
    (ValueError(), "the reason is not known"), (ValueError("bad\n length."), "bad length"),
])
def test_the_reason_of_a_library_is_given_in_words(error: Exception, words: str) -> None:
    assert words_of(error, "the reason is not known") == words
