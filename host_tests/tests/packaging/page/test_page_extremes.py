"""Numbers in the editor that were typed by mistake: the page goes on answering, and the robot comes back."""

from __future__ import annotations

import pytest
from conftest import PAGE

pytestmark = pytest.mark.nightly

SET = """const field = document.getElementById(arguments[0]);
field.value = arguments[1];
for (const type of ['input', 'change']) field.dispatchEvent(new Event(type, {bubbles: true}));
window.drawn = false;
requestAnimationFrame(() => requestAnimationFrame(() => { window.drawn = true; }));"""


@pytest.mark.parametrize(("field", "number"), [
    ("field-vehicle.wheel_radius_m", "1e6"), ("field-vehicle.com_x_m", "1e6"), ("field-vehicle.com_y_m", "1e308")])
def test_a_length_typed_by_mistake_does_not_stop_the_page(window, field, number):
    window.open(PAGE, prefers_reduced_motion="reduce")
    window.js("document.querySelector('input[name=view][value=draw]').click()")
    before = window.js("return document.getElementById(arguments[0]).value", field)
    for value in (number, before):
        window.js(SET, field, value)
        window.wait("return window.drawn")
    assert window.value(field) == before
    assert window.errors() == []


@pytest.mark.parametrize("mass, where", [("1e308", "vehicle.mass_kg: "), ("1e-300", "")], ids=["1e308", "1e-300"])
def test_a_mass_out_of_reason_is_refused_below_its_field_in_the_cores_words(window, mass, where):
    window.open(PAGE, prefers_reduced_motion="reduce")
    window.type("field-vehicle.mass_kg", mass)
    told = "a result leaves the range of double precision; check inputs and units"
    assert (window.text("field-vehicle.mass_kg-error"), window.text("banner")) == (told, where + told)
    window.js("document.getElementById('step').click()")
    assert window.text("time") == "0.00 s"
    assert "NaN" not in window.js("return document.body.innerText") and window.errors() == []
