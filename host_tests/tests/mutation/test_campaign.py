"""A campaign over a small project: it ends with its time, keeps what it found, and goes on from there."""

from __future__ import annotations

import math
import time

import pytest

from laconic.mutation import campaign, compiled
from laconic.mutation.campaign import Campaign
from laconic.mutation.equivalent import Equivalent

SOURCE = """\
int larger(int a, int b) { return a > b ? a : b; }
int lost(int a) { return a + 3; }
"""
TEST = """\
int larger(int a, int b);
int main(void) { return larger(2, 3) != 3 || larger(5, 4) != 5; }
"""


@pytest.fixture
def campaign_of(trials_of, monkeypatch, tmp_path):
    """A new campaign over the same sources and results, with a list of equivalents."""
    trials, sources = trials_of({"larger.c": SOURCE}, {"test_larger.c": TEST})
    for folder in ("core_c/tests", "firmware_stub/tests", "fmu/tests"):
        (sources / folder).mkdir(parents=True)
    monkeypatch.setattr(campaign, "SOURCE_DIR", sources)
    monkeypatch.setattr(campaign, "files_of", lambda _: ["core_c/larger.c"])
    monkeypatch.setattr(campaign, "sources_missing", lambda: None)
    monkeypatch.setattr(compiled, "families", lambda *_: trials.compiled.families)
    monkeypatch.setattr(campaign, "MANY", 2)

    def make(listed: list[Equivalent]) -> Campaign:
        monkeypatch.setattr(campaign, "read_equivalents", lambda: listed)
        return Campaign(None, 1, tmp_path / "kept")

    return make


def test_without_time_nothing_is_built_or_tried(campaign_of, monkeypatch):
    monkeypatch.setattr(campaign, "bench_of", lambda *_: pytest.fail("it has no time to build"))
    tally = campaign_of([]).run(None, time.monotonic() - 1, lambda _: None)
    assert tally.total.total() == 0


def test_with_time_all_are_tried_once_and_kept(campaign_of, monkeypatch):
    tried: list[float] = []
    first = campaign_of([])
    tally = first.run(None, math.inf, tried.append)
    assert tally.total.total() == len(first.mutants) == len(tried)
    assert tally.total["killed"] > 0 and {each.function for each in tally.survivors} >= {"lost"}
    monkeypatch.setattr(compiled, "families", lambda *_: pytest.fail("all is known"))
    assert campaign_of([]).run(None, math.inf, tried.append).total == tally.total


def test_what_is_listed_goes_to_the_exact_trial_and_is_told_when_a_test_notices_it(campaign_of):
    mutants = campaign_of([]).mutants
    smaller, lost = (next(each for each in mutants if text in each.after) for text in ("a <= b", "a - 3"))
    listed = [Equivalent(each.file, each.function, each.before, each.after, "by this test") for each in (smaller, lost)]
    tally = campaign_of(listed).run(None, math.inf, lambda _: None)
    assert lost not in tally.survivors
    assert tally.listed_yet_killed == [smaller]
