"""Flipped bits, lost power and wrong clocks: a sample of what `laconic soak faults` tries whole."""

from __future__ import annotations

import re

import pytest
from laconic.soak import faults
from laconic.soak._campaigns.memory import NODE, REALS, RESTART, count, total, tried, worst_ms
from laconic.soak._campaigns.session import figures

from laconic.base.paths import SOURCE_DIR
from laconic.errors import BadInput

SAMPLE = 2000
SEED = 1
LONGEST_MS = 1000.0 + 20.0  # a round begins anew behind the change, and ticks come each 5 ms


def share_of_page(real: str, column: int) -> float:
    """The silent ones among all bits, as docs/assurance.md states them; 1: without checks, 2: sum and range, 3: all."""
    page = (SOURCE_DIR / "docs" / "assurance.md").read_text(encoding="utf-8")
    row = re.search(rf"^\| {real} \| all \|(.*)\|$", page, re.MULTILINE)
    assert row is not None
    bits, _, *cells = (cell.strip() for cell in row.group(1).split("|"))
    return int(cells[column - 1].split(",")[1]) / int(bits)


@pytest.mark.parametrize("real", REALS)
def test_with_all_checks_no_flipped_bit_changes_the_motion_unnoticed(real: str) -> None:
    whole = total(tried(real, "all", SEED, 0, SAMPLE))
    assert count(whole, tuple(whole)) == SAMPLE
    assert count(whole, ("silent",)) == 0 == count(whole, RESTART)
    assert count(whole, NODE) > 0.2 * SAMPLE
    assert worst_ms(whole, NODE) <= LONGEST_MS


def test_without_them_some_do_and_no_more_than_the_page_says() -> None:
    for column, checks in enumerate(("none", "sum"), start=1):
        silent = count(total(tried("double", checks, SEED, 0, SAMPLE)), ("silent",))
        expected = share_of_page("double", column) * SAMPLE
        assert 0 < silent <= expected + 4.0 * expected**0.5, checks
    assert share_of_page("double", 3) == 0.0 == share_of_page("single", 3)


@pytest.mark.parametrize("what", ["power", "clocks"])
def test_lost_power_and_wrong_clocks_move_nothing_unasked_and_change_no_bit(what: str) -> None:
    told, good = figures(what)
    assert good, told
    assert len(told) > 9


def test_bits_of_another_count_and_other_kinds_of_fault_are_refused() -> None:
    with pytest.raises(BadInput, match="did you mean memory"):
        faults.soak(1.0, SEED, lambda _: None, only="memor")
    with pytest.raises(BadInput, match="--sample 5"):
        faults.soak(1.0, SEED, lambda _: None, only="power", sample=5)
