"""The page for everybody: narrow and wide, light and dark, by keyboard and by screen reader."""

from __future__ import annotations

import pytest
from conftest import PAGE

from laconic_build.page.browser import Browser

pytestmark = pytest.mark.nightly

SHOTS = PAGE.parent
SIZES = [(390, 844), (1400, 900)]


@pytest.mark.parametrize(("width", "height"), SIZES)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_cut_off_and_every_text_has_contrast(window, width, height, scheme):
    window.open(PAGE, width, height, prefers_color_scheme=scheme, prefers_reduced_motion="reduce")
    window.js("for (let k = 0; k < 60; k++) document.getElementById('step').click()")
    window.wait("return document.getElementById('figures').dataset.pose")
    window.shot(SHOTS / f"page_{width}_{scheme}.png", whole=width < 600)
    assert window.js("return document.documentElement.scrollWidth") <= width
    if width > 1000:
        assert window.js("return document.documentElement.scrollHeight") <= height
    assert window.js(CUT_OFF) == []
    low = window.js(CONTRASTS)
    assert low == []


@pytest.mark.parametrize("time", ["9.99 s", "11.50 s", "4711.50 s"])
def test_the_clock_stays_on_one_line_on_a_phone(window, time):
    window.open(PAGE, 390, 844, prefers_reduced_motion="reduce")
    window.click("play")
    height = "return document.getElementById('time').getBoundingClientRect().height"
    window.js("document.getElementById('time').textContent = '0 s'")
    one_line = window.js(height)
    window.js("document.getElementById('time').textContent = arguments[0]", time)
    assert window.js(height) == one_line
    assert window.js("return document.documentElement.scrollWidth") <= 390
    assert window.js(CUT_OFF) == []


CUT_OFF = """return [...document.querySelectorAll('button, select, label, output, h1, h2, summary, dd')]
    .filter((each) => each.checkVisibility() && each.offsetWidth > 2)
    .filter((each) => each.scrollWidth > each.clientWidth + 1 && each.clientWidth > 0 && each.tagName !== 'SELECT')
    .map((each) => each.outerHTML.slice(0, 100));"""

CONTRASTS = """
const parse = (text) => (text.match(/[\\d.]+/g) || []).map(Number);
const light = ([r, g, b]) => [r, g, b].map((v) => v / 255)
    .map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
const behind = (each) => {
    for (let at = each; at; at = at.parentElement) {
        const colour = parse(getComputedStyle(at).backgroundColor);
        if (colour.length === 3 || colour[3] === 1) return colour;
    }
    return [255, 255, 255];
};
const low = [];
for (const each of document.querySelectorAll('body *')) {
    const own = [...each.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
    if (!own || !each.checkVisibility() || each.closest(':disabled')) continue;
    const [a, b] = [light(parse(getComputedStyle(each).color)), light(behind(each))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) low.push(`${ratio.toFixed(2)} ${each.outerHTML.slice(0, 80)}`);
}
return low;"""


def named_controls(page: Browser) -> list[tuple[str, str]]:
    """Role and name of everything that takes the focus, as a screen reader has them."""
    nodes = page.chromium("Accessibility.getFullAXTree")["nodes"]
    found = []
    for node in nodes:
        properties = {each["name"]: each["value"].get("value") for each in node.get("properties", [])}
        role = node["role"]["value"]
        if not node.get("ignored") and properties.get("focusable") and role not in ("RootWebArea", "dialog"):
            found.append((role, node.get("name", {}).get("value", "")))
    return found


def test_every_control_has_a_name_for_screen_readers(page):
    page.js("for (const each of document.querySelectorAll('details')) each.open = true")
    for view in ("drive", "draw"):
        page.click(f"[name=view][value={view}]")
        for mode in ("velocity", "wheels") if view == "drive" else ():
            page.click(f"[name=drive][value={mode}]")
            controls = named_controls(page)
            assert len(controls) > 30
            assert [role for role, name in controls if not name.strip()] == []
    assert [role for role, name in named_controls(page) if not name.strip()] == []


def test_the_tab_key_goes_through_every_control_and_shows_where_it_is(page):
    page.js("document.activeElement.blur()")
    seen: list[str] = []
    for _ in range(60):
        page.press("Tab")
        where, outline = page.js("""const each = document.activeElement, shown = each.matches('.segments input')
            ? each.nextElementSibling : each;
            return [each.id || each.name || each.tagName, getComputedStyle(shown).outlineStyle];""")
        if where == "BODY" or (seen and where == seen[0]):
            break
        assert outline != "none", where
        seen.append(where)
    for name in ("robot", "export-toml", "view", "play", "step", "restart", "speed", "stage", "zoom-in", "drive",
                 "stop", "method", "step-size", "field-vehicle.mass_kg", "friction", "fleet"):
        assert name in seen, name
    assert seen.index("robot") < seen.index("play") < seen.index("stage") < seen.index("method")


def test_one_polite_region_tells_what_happens_and_refusals_are_alerts(page):
    live = "[...document.querySelectorAll('[aria-live], [role=status], [role=alert]')]"
    assert page.js(f"return {live}.map((each) => each.id)") == ["banner", "status"]
    page.click("step")
    assert page.text("status") == "at 0.10 s"


@pytest.mark.parametrize("width", [390, 1400])
def test_the_editor_fits_narrow_and_wide(window, width):
    window.open(PAGE, width, 844, prefers_reduced_motion="reduce")
    window.choose("robot", "own")
    window.shot(SHOTS / f"page_{width}_draw.png", whole=width < 600)
    assert window.js("return document.documentElement.scrollWidth") <= width
    assert window.js(CUT_OFF) == []
    assert window.errors() == []
