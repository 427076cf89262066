"""`laconic soak targets`: what it tells of targets that agree, differ, are not here, or were not reached."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from laconic.soak import StoppedEarly, targets
from laconic.targets import Bits


@dataclass
class Made:
    """A target that has these hashes, or is missing something, or is interrupted."""

    name: str
    hashes: tuple[str, ...] = ("11", "22")
    missing: str = ""
    interrupts: bool = False

    def lacks(self) -> str:
        return self.missing

    def bits(self, folder, real) -> Bits:
        if self.interrupts:
            raise KeyboardInterrupt
        return Bits(self.hashes)


def soaked(monkeypatch, *made: Made, least: int = 1):
    monkeypatch.setattr(targets, "TARGETS", made)
    monkeypatch.setattr(targets, "LEAST", least)
    return targets.soak(1.0, 1, lambda _: None)


def test_targets_of_one_hash_pass_and_one_that_is_not_here_is_told(monkeypatch):
    told = soaked(monkeypatch, Made("a"), Made("b"), Made("c", missing="emulator"))
    assert told == {"passed": True, "targets": 2, **dict.fromkeys("ab", "11 22, 11 22"), "c": "not here: no emulator"}


def test_another_hash_fails(monkeypatch):
    assert not soaked(monkeypatch, Made("a"), Made("b", hashes=("11", "23")))["passed"]


def test_too_few_targets_fail(monkeypatch):
    assert not soaked(monkeypatch, Made("a"), least=2)["passed"]


@pytest.mark.parametrize(("first", "passed"), [(Made("b"), True), (Made("b", hashes=("9",)), False)])
def test_an_interrupted_run_tells_what_was_found(monkeypatch, first, passed):
    with pytest.raises(StoppedEarly) as stopped:
        soaked(monkeypatch, Made("a"), first, Made("c", interrupts=True), Made("d"), least=9)
    assert stopped.value.result["passed"] is passed
    assert stopped.value.result["a"] == "11 22, 11 22"
    assert (stopped.value.result["c"], stopped.value.result["d"]) == ("not reached", "not reached")
