"""The page for everybody: narrow and wide, light and dark, by keyboard and by screen reader."""

from __future__ import annotations

import math

import pytest
from conftest import PAGE

from laconic_build.page.browser import Browser

SHOTS = PAGE.parent
SIZES = [(390, 844), (1400, 900)]


@pytest.mark.nightly
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


@pytest.mark.nightly
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


@pytest.mark.nightly
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


@pytest.mark.nightly
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


@pytest.mark.nightly
def test_one_polite_region_tells_what_happens_and_refusals_are_alerts(page):
    live = "[...document.querySelectorAll('[aria-live], [role=status], [role=alert]')]"
    assert page.js(f"return {live}.map((each) => each.id)") == ["banner", "status"]
    page.click("step")
    assert page.text("status") == "at 0.10 s"


@pytest.mark.nightly
@pytest.mark.parametrize("width", [390, 1400])
def test_the_editor_fits_narrow_and_wide(window, width):
    window.open(PAGE, width, 844, prefers_reduced_motion="reduce")
    window.choose("robot", "own")
    window.shot(SHOTS / f"page_{width}_draw.png", whole=width < 600)
    assert window.js("return document.documentElement.scrollWidth") <= width
    assert window.js(CUT_OFF) == []
    assert window.errors() == []


# ---- Wheels drawn on the page: placed, turned, added and deleted by pointer, keys and numbers.

@pytest.fixture
def drawing(page: Browser) -> Browser:
    page.choose("robot", "own")
    assert not page.js("return document.getElementById('drawing').hidden")
    return page


def wheel(page: Browser) -> tuple[float, float, float]:
    """Place and axle [m, m, °] of the chosen wheel."""
    x, y, axle = (float(page.value(f"wheel-{key}")) for key in ("x_m", "y_m", "axle_rad"))
    return x, y, axle


def wheels(page: Browser) -> int:
    return int(page.js("return document.getElementById('wheel-list').children.length"))


def pixel(page: Browser, x_m: float, y_m: float) -> tuple[float, float]:
    """Where a place of the body is in the window: four wheels reach 0.3 m from the origin."""
    left, top, width, height = page.js("""const box = document.getElementById('drawing').getBoundingClientRect();
        return [box.left, box.top, box.width, box.height];""")
    scale = min(width, height) / (2.5 * (math.hypot(0.2, 0.15) + 0.05))
    return left + width / 2 - scale * y_m, top + height / 2 - scale * x_m


@pytest.mark.nightly
def test_a_wheel_is_dragged_to_its_place(drawing):
    drawing.drag(pixel(drawing, -0.2, -0.15), pixel(drawing, -0.1, -0.1))
    assert wheel(drawing) == pytest.approx((-0.1, -0.1, -90), abs=0.006)
    assert drawing.js("return document.querySelector('#wheel-list [aria-pressed=true]').textContent") == "4"
    assert drawing.text("status").startswith("Wheel 4, mecanum, −0.1")


@pytest.mark.nightly
def test_the_dot_beside_a_wheel_turns_it(drawing):
    left, top = pixel(drawing, 0.2, 0.15)
    right = pixel(drawing, 0.2, 0.1)[0]
    far = right - left + 34  # the dot is 34 pixels beyond the tread, along the axle
    drawing.drag((left + far, top), (left, top - far))
    assert wheel(drawing) == pytest.approx((0.2, 0.15, 0))


@pytest.mark.nightly
def test_a_double_click_adds_a_wheel_where_it_is(drawing):
    x, y = pixel(drawing, 0.05, -0.05)
    drawing.call("/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
        {"type": "pointerMove", "x": round(x), "y": round(y)},
        *[{"type": kind, "button": 0} for kind in ("pointerDown", "pointerUp") * 2]]}]})
    assert wheels(drawing) == 5
    assert wheel(drawing) == pytest.approx((0.05, -0.05, -90), abs=0.006)


@pytest.mark.nightly
def test_keys_move_turn_choose_add_and_delete(drawing):
    drawing.js("document.getElementById('drawing').focus()")
    drawing.press("Up", "Left", "Left")
    assert wheel(drawing) == pytest.approx((0.21, 0.17, -90))
    drawing.key(("keyDown", "Shift"), ("keyDown", "Down"), ("keyUp", "Down"), ("keyUp", "Shift"))
    drawing.press("Right", ",")
    assert wheel(drawing) == pytest.approx((0.209, 0.16, -85))
    drawing.press(".", ".", "PageDown")
    assert wheel(drawing) == pytest.approx((0.2, -0.15, -90))
    drawing.press("PageUp")
    assert wheel(drawing)[2] == pytest.approx(-95)
    drawing.press("Insert")
    assert wheels(drawing) == 5 and wheel(drawing)[:2] == (0, 0)
    drawing.press("Delete")
    assert wheels(drawing) == 4


@pytest.mark.nightly
def test_numbers_kinds_and_buttons_make_another_robot(drawing):
    drawing.click("#wheel-list button:nth-child(2)")
    drawing.type("wheel-x_m", "0.25")
    drawing.type("wheel-y_m", "-0.2")
    drawing.type("wheel-axle_rad", "-80")
    drawing.type("wheel-roller_rad", "-40")
    assert wheel(drawing) == pytest.approx((0.25, -0.2, -80))
    drawing.choose("wheel-kind", "fixed")
    assert drawing.js("return document.getElementById('wheel-roller_rad').disabled")
    drawing.choose("wheel-kind", "omni")
    assert float(drawing.value("wheel-roller_rad")) == pytest.approx(90)
    drawing.click("add-wheel")
    assert wheels(drawing) == 5
    for left in (4, 3, 2, 1, 0):
        drawing.click("delete-wheel")
        assert wheels(drawing) == left
    assert drawing.js("return document.getElementById('delete-wheel').disabled")
    drawing.click("[name=view][value=drive]")
    drawing.js("document.getElementById('step').click()")
    assert drawing.text("time") == "0.10 s"  # a puck without wheels


@pytest.mark.nightly
def test_wheels_that_cannot_turn_the_robot_are_told_in_the_cores_words_until_the_ground_lets_them_slip(drawing):
    for number in (1, 2, 3, 4):
        drawing.click(f"#wheel-list button:nth-child({number})")
        drawing.choose("wheel-kind", "fixed")
    assert "fixed wheels on parallel axle lines only drive straight" in drawing.text("wheel-error")
    assert drawing.text("banner") == drawing.text("wheel-error")
    drawing.js("document.getElementById('step').click()")
    assert drawing.text("time") == "0.00 s"
    drawing.click("friction")
    assert drawing.text("wheel-error") == ""
    drawing.js("document.getElementById('step').click()")
    assert drawing.text("time") == "0.10 s"


@pytest.mark.nightly
@pytest.mark.parametrize(("key", "text", "told"), [
    ("x_m", "far", "vehicle.wheel[1].x_m: “far” is no number; give one"),
    ("x_m", "0x10", "vehicle.wheel[1].x_m: “0x10” is no number; give one"),
    ("y_m", "", "vehicle.wheel[1].y_m: a number is missing; give one"),
    ("roller_rad", "0", "vehicle.wheel[1].roller_rad: with 0 rad the roller axis lies along the axle"),
    ("axle_rad", "1e99", "vehicle.wheel[1].axle_rad:")])
def test_a_wheels_number_that_the_core_refuses_is_told_below(drawing, key, text, told):
    drawing.type(f"wheel-{key}", text)
    assert drawing.text("wheel-error").startswith(told)
    drawing.choose("robot", "own")
    assert drawing.text("wheel-error") == ""


@pytest.mark.nightly
def test_a_wheel_too_many_is_refused_in_the_pages_words_and_not_drawn(drawing):
    for _ in range(12):
        drawing.click("add-wheel")
    assert (wheels(drawing), drawing.text("wheel-error")) == (16, "")
    assert wheel(drawing)[:2] == pytest.approx((0, -0.55))  # each beside the one before, so that all are seen
    drawing.click("add-wheel")
    drawing.js("document.getElementById('drawing').focus()")
    drawing.press("Insert")
    assert wheels(drawing) == 16
    assert drawing.text("wheel-error") == "A robot has 16 wheels at most; delete one first, or move one."
    drawing.click("delete-wheel")
    assert (wheels(drawing), drawing.text("wheel-error")) == (15, "")


@pytest.mark.nightly
def test_a_wheel_that_is_deleted_takes_its_drive_with_it(page):
    page.choose("robot", "robotino2")
    assert page.js("return document.querySelector('[name=drive][value=scene]').checked")
    page.click("[name=view][value=draw]")
    page.click("#wheel-list button:nth-child(1)")
    page.click("delete-wheel")
    assert (wheels(page), page.text("wheel-error")) == (2, "")
    page.click("export-toml")
    assert page.js("return document.getElementById('export-text').value").count("voltage_V[") == 2


@pytest.mark.nightly
def test_a_robot_that_is_refused_is_not_exported(drawing):
    drawing.type("wheel-roller_rad", "0")
    disabled = "return ['export-toml', 'export-c'].map((id) => document.getElementById(id).disabled)"
    assert drawing.js(disabled) == [True, True]
    drawing.type("wheel-roller_rad", "45")
    assert drawing.js(disabled) == [False, False]
