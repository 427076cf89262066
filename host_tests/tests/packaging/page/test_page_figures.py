"""The command that prints what the page costs counts frames as they were, and the page has time to spare."""

from __future__ import annotations

import hashlib
import json

import pytest
from conftest import PAGE

from laconic_build.page.browser import BROWSER, DRIVER
from laconic_build.page.figures import figures_of, page_figures, text_of

pytestmark = pytest.mark.nightly

FRAME_MS = 1000.0 / 60.0


def test_frames_that_the_display_showed_without_the_page_are_counted():
    at_rest = [FRAME_MS * k for k in range(120)]
    shown = [k for k in range(300) if k not in (50, 100, 101)]
    found = figures_of(390, 21, at_rest, [FRAME_MS * k for k in shown], [2.0] * 290 + [30.0] * 7, 1.5)
    assert (found.left_out, found.frames) == (3, len(shown) - 1)
    assert found.worst_interval_ms == pytest.approx(3.0 * FRAME_MS)
    assert found.rate_Hz == pytest.approx(60.0) and found.display_ms == pytest.approx(FRAME_MS)
    assert (found.frame_ms, found.frame_99_ms, found.worst_frame_ms) == (2.0, 30.0, 30.0)
    assert found.main_thread_ms == pytest.approx(1500.0 / len(shown))
    assert "60.0 frames/s" in text_of(found) and "3 of 299 frames left out" in text_of(found)


def test_a_busy_machine_does_not_slow_the_display_down():
    late = [FRAME_MS * k for k in range(120) if k % 3]  # a third of the frames at rest came late
    assert figures_of(390, 21, late, late, [1.0] * 80, 0.1).display_ms == pytest.approx(FRAME_MS)


@pytest.mark.skipif(not (PAGE.exists() and BROWSER and DRIVER), reason="needs the page, chromium and chromedriver")
def test_the_page_needs_less_than_a_frame_of_the_processor_at_both_widths(capsys):
    page_figures(PAGE, 1.0, "kuka_youbot", as_json=True)
    found = json.loads(capsys.readouterr().out)
    assert (found["bytes"], found["sha256"]) == (PAGE.stat().st_size, hashlib.sha256(PAGE.read_bytes()).hexdigest())
    assert found["bits"].startswith("Same bits as the native core")
    assert [(row["width"], row["vehicles"]) for row in found["widths"]] == [(390, 21), (1400, 21)]
    for row in found["widths"]:
        assert row["frames"] > 5
        assert row["main_thread_ms"] < FRAME_MS  # of processor time, whatever else the machine does
