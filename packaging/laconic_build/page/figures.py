"""What the page costs: its size, and how evenly it draws twenty further vehicles in a real browser.

An interval is that between two frames as requestAnimationFrame gives them. The time of a frame is that of the page's
own code in it; the main thread's, with style, layout and paint, is a mean over the frames. The page at rest, measured
just before, tells the rate of the display, which a headless Chromium has at 60 Hz.
"""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from laconic_build.page.browser import BROWSER, DRIVER, Browser

SIZES = ((390, 844), (1400, 900))
REST_S = 1.0
LATE = 1.5  # intervals of the display's: a frame was left out

COUNT_FRAMES = """
const ask = window.requestAnimationFrame.bind(window), frames = { at: [], took: [] };
window.requestAnimationFrame = (call) => ask((now) => {
    const start = performance.now();
    call(now);
    frames.at.push(now);
    frames.took.push(performance.now() - start);
});
window.framesSince = () => {
    const [at, took] = [frames.at, frames.took];
    [frames.at, frames.took] = [[], []];
    return [at, took];
};"""
WAIT = "const [ms, done] = arguments; setTimeout(() => done(window.framesSince()), ms);"


@dataclass(frozen=True)
class Figures:
    """Of one width of the window; all times in milliseconds."""

    width: int
    vehicles: int
    display_ms: float        # interval at rest
    interval_ms: float       # median
    worst_interval_ms: float
    frames: int
    left_out: int            # frames of the display without one of the page
    frame_ms: float          # of the page's code, median
    frame_99_ms: float
    worst_frame_ms: float
    main_thread_ms: float    # of processor time a frame, mean

    @property
    def rate_Hz(self) -> float:
        """Frames a second."""
        return 1000.0 / self.interval_ms


def page_figures(page: Path, seconds: float, scene: str, as_json: bool) -> None:
    """Prints the figures of a page that was built."""
    if not (BROWSER and DRIVER):
        sys.exit("needs chromium and chromedriver (Debian: chromium chromium-driver)")
    made = page.read_bytes()
    browser = Browser(COUNT_FRAMES)
    try:
        rows = [measured(browser, page, width, height, seconds, scene) for width, height in SIZES]
        bits = str(browser.js("return document.getElementById('bits').textContent")).strip()
    finally:
        browser.close()
    facts = {"file": page.name, "bytes": len(made), "sha256": hashlib.sha256(made).hexdigest(), "bits": bits}
    if as_json:
        print(json.dumps(facts | {"widths": [asdict(row) for row in rows]}, indent=1))
        return
    print(f"{page.name}: {len(made):,} bytes, sha256 {facts['sha256']}\n{bits}")
    for row in rows:
        print(text_of(row))


def text_of(row: Figures) -> str:
    """One width in words."""
    return "\n  ".join((
        f"{row.width} px, {row.vehicles} vehicles: {row.rate_Hz:.1f} frames/s, the display {1e3 / row.display_ms:.1f}",
        f"interval: median {row.interval_ms:.2f}, worst {row.worst_interval_ms:.1f} ms; "
        f"{row.left_out} of {row.frames + row.left_out} frames left out",
        f"code of a frame: median {row.frame_ms:.2f}, 99 % {row.frame_99_ms:.2f}, worst {row.worst_frame_ms:.1f} ms; "
        f"main thread: {row.main_thread_ms:.2f} ms of processor a frame"))


def measured(browser: Browser, page: Path, width: int, height: int, seconds: float, scene: str) -> Figures:
    """The scene's own drive with twenty further vehicles in a window of that size."""
    browser.open(page, width, height, prefers_reduced_motion="reduce")
    browser.choose("robot", scene)
    at_rest, _ = frames_of(browser, REST_S)
    browser.js("for (const id of ['fleet', 'play']) document.getElementById(id).click()")  # on a phone: folded in
    browser.wait("return Number(document.getElementById('figures').dataset.vehicles) > 20")
    before = main_thread_s(browser)
    at, took = frames_of(browser, seconds)
    main_s = main_thread_s(browser) - before
    vehicles = int(browser.js("return document.getElementById('figures').dataset.vehicles"))
    return figures_of(width, vehicles, at_rest, at, took, main_s)


def figures_of(width: int, vehicles: int, at_rest: list[float], at: list[float], took: list[float],
               main_s: float) -> Figures:
    """From the instants of frames at rest and while it plays, and how long each frame's code took."""
    display_ms = sorted(intervals(at_rest))[len(at_rest) // 4]  # other work only makes intervals longer
    gaps = intervals(at)
    left_out = sum(round(gap / display_ms) - 1 for gap in gaps if gap > LATE * display_ms)
    return Figures(width, vehicles, display_ms, middle(gaps), max(gaps), len(gaps), left_out, middle(took),
                   sorted(took)[int(0.99 * (len(took) - 1))], max(took), 1e3 * main_s / len(at))


def frames_of(browser: Browser, seconds: float) -> tuple[list[float], list[float]]:
    """Instants and times of the frames in so many seconds from now."""
    browser.js("window.framesSince()")
    at, took = browser.call("/execute/async", {"script": WAIT, "args": [1e3 * seconds]})
    return at, took


def main_thread_s(browser: Browser) -> float:
    """All that the page's main thread has done so far."""
    browser.chromium("Performance.enable", timeDomain="threadTicks")  # processor time, whatever else the machine does
    found: list[dict[str, Any]] = browser.chromium("Performance.getMetrics")["metrics"]
    return float(next(each["value"] for each in found if each["name"] == "TaskDuration"))


def intervals(at: list[float]) -> list[float]:
    """Between one and the next."""
    return [later - earlier for earlier, later in zip(at, at[1:], strict=False)]


def middle(values: list[float]) -> float:
    """The median."""
    return sorted(values)[len(values) // 2]
