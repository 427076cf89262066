"""How the page is made: the same bytes at every run, and modules that the bundler cannot join are told."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import PAGE

from laconic.base.paths import SCENE_DIR, SOURCE_DIR, build_dir
from laconic_build.page import page
from laconic_build.page.bundle import BadBundle, bundle
from laconic_build.page.page import TooLarge, make_page

SOURCES = SOURCE_DIR / "web" / "page"
BINDING = build_dir() / "npm/laconic/src"
built = pytest.mark.skipif(not PAGE.exists(), reason="the page was not built: no clang with wasm-ld")


def make(out: Path) -> bytes:
    make_page(SOURCES, BINDING, SCENE_DIR, PAGE.parent / "native_hash.txt", out)
    return out.read_bytes()


@built
def test_making_it_again_gives_the_same_bytes(tmp_path):
    assert make(tmp_path / "again.html") == PAGE.read_bytes()


@built
def test_a_page_that_grows_beyond_its_promise_is_not_made(tmp_path, monkeypatch):
    monkeypatch.setattr(page, "MOST_BYTES", 1000)
    with pytest.raises(TooLarge, match=r"page\.html has \d+ bytes, 1000 at most"):
        make(tmp_path / "page.html")
    assert not (tmp_path / "page.html").exists()


@built
def test_it_names_no_other_address_than_its_own_data():
    assert set(re.findall(r"\b(?:https?|wss?|ftp)://[\w.]+", PAGE.read_text(encoding="utf-8"))) == set()


def bundled(folder: Path, **modules: str) -> str:
    for name, text in modules.items():
        (folder / f"{name}.js").write_text(text, encoding="utf-8")
    return bundle(folder / "main.js", {"other": folder / "there.js"})


def test_modules_are_joined_in_the_order_of_their_imports(tmp_path):
    text = bundled(tmp_path, main='// a\nimport { b } from "./b.js";\nimport { t } from "other";\nb(t);\n',
                   b='import { t } from "other";\nexport function b() {}\n', there="export const t = 1;\n")
    assert text.split("\n") == ["const t = 1;", "", "function b() {}", "", "// a", "b(t);", ""]


@pytest.mark.parametrize(("modules", "told"), [
    ({"main": 'import { a } from "./a.js";\nconst a1 = a;\n', "a": "export const a = 1;\nconst a1 = 2;\n"},
     "main.js: a1 is a name of a.js, too; rename one of them"),
    ({"main": 'import { a } from "./a.js";\n', "a": 'import { m } from "./main.js";\nexport const a = 1;\n'},
     "main.js: imports itself by way of a.js"),
    ({"main": 'import a from "./a.js";\n'}, "main.js: 'import a from \"./a.js\";' is no import or export that"),
    ({"main": 'export default 1;\n'}, "main.js: 'export default 1;' is no import or export that"),
    ({"main": 'const end = "</script>";\n'}, "main.js: holds the end of a script element"),
])
def test_what_the_bundler_cannot_join_is_one_line(tmp_path, modules, told):
    with pytest.raises(BadBundle, match=re.escape(told)):
        bundled(tmp_path, **modules)
