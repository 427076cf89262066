"""One browser for all tests of the page; each test opens the page anew."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from laconic.base.paths import build_dir
from laconic_build.page import browser as chromium

PAGE = build_dir() / "page/laconic.html"


@pytest.fixture(scope="session")
def window() -> Iterator[chromium.Browser]:
    if not PAGE.exists():
        pytest.skip("the page was not built: no clang with wasm-ld")
    if not (chromium.BROWSER and chromium.DRIVER):
        pytest.skip("needs chromium and chromedriver")
    browser = chromium.Browser()
    yield browser
    browser.close()


@pytest.fixture
def page(window: chromium.Browser) -> Iterator[chromium.Browser]:
    """The page at rest, its robot at the start; at the end nothing may stand in the console."""
    window.open(PAGE, prefers_reduced_motion="reduce")
    yield window
    assert window.errors() == []
    assert "NaN" not in window.js("return document.body.innerText")
