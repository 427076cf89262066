"""An array that is only longer is known, in a structure, too, unless something asks its length."""

from __future__ import annotations

import pytest

from laconic.mutation.alike import meaning
from laconic.mutation.lengths import Asked, grown
from laconic.mutation.listed import BY_LENGTH, Listed
from laconic.mutation.operators import parsed

SOURCE = """\
#define COUNT(of) (sizeof(of) / sizeof(of)[0])
typedef struct room {
    int plain[3], asked[N - 1], grid[2][P * (N + 1)];
} room;
static const int table[] = {1, 2}, two[2] = {1, 2};
int used(room *r) { int own[3]; return COUNT(own) + SUM(own, r->plain[0]) + COUNT(r->asked) + r->grid[0][0]; }
"""


def told(text: str):
    return meaning(parsed(text.encode()).root_node)


@pytest.mark.parametrize(("before", "after", "names"), [
    ("plain[3]", "plain[4]", {"plain"}), ("N - 1", "N", {"asked"}), ("N - 1", "N - 0", None),
    ("plain[3]", "plain[2]", None), ("N - 1", "N + 1", None), ("grid[2]", "grid[5]", {"grid"}),
    ("(N + 1)", "(N + 2)", {"grid"}), ("(N + 1)", "(N + 1 + 1)", {"grid"}),
    ("P * (", "(1 + P) * (", {"grid"}), ("N + 1", "M + 2", None), ("own[3]", "own[3 * 2]", {"own"}),
    ("table[]", "table[3]", None), ("plain[3], asked", "plain[4], other", None), ("[0][0]", "[0][1]", None),
    ("{1, 2}, two[2]", "{1, 3}, two[3]", None), ("return", "return 1 +", None), (" r->plain", "(r->plain)", set())])
def test_what_is_only_longer_is_named(before, after, names):
    assert grown(told(SOURCE), told(SOURCE.replace(before, after))) == names


def test_the_length_of_an_array_is_asked_by_sizeof_or_by_a_macro_that_says_it_and_not_of_an_element():
    header = "#define COUNT(of) (sizeof(of) / \\\n    sizeof(of)[0])\n#define R(x) ((real)(x))\n"
    text = """\
#define ALL(of) for (k = 0; k < COUNT(of); k++)
x = sizeof a[0] + A; y = sizeof(b) / B; memset(d, 0, sizeof d);
ALL(c->e) R(f); z = COUNT(g(h(i), j)) + R(k);
"""
    asked = Asked({"a.h": header, "a.c": text, "b.c": "x = sizeof l;"})
    assert asked.by("a.c") == {"of", "b", "d", "c", "e", "g", "h", "i", "j"}
    assert asked.by("a.h") == asked.by("a.c") | {"l"} and asked.by("b.c") == {"l"}
    assert asked.by("c.c") is None


@pytest.mark.parametrize("file", ["core_c/tests/a.c", "packages/a.c"])
def test_of_an_array_outside_of_the_product_nothing_is_known(tmp_path, file):
    (tmp_path / file).parent.mkdir(parents=True)
    (tmp_path / file).write_text("int own[3];\n")
    assert Listed([], tmp_path).reason(file, (8, 9, "4")) is None


@pytest.mark.parametrize(("before", "after", "why"), [
    ("plain[3]", "plain[4]", BY_LENGTH), ("grid[2]", "grid[3]", BY_LENGTH), ("two[2]", "two[3]", BY_LENGTH),
    ("N - 1", "N", None), ("own[3]", "own[4]", None), ("plain[3]", "plain[2]", None)])
def test_a_survivor_with_a_longer_array_is_no_fault_where_nothing_asks_the_length(tmp_path, before, after, why):
    (tmp_path / "core_c").mkdir()
    (tmp_path / "core_c/a.c").write_text(SOURCE)
    at = SOURCE.index(before)
    change = at, at + len(before), after
    listed = Listed([], tmp_path)
    assert listed.reason("core_c/a.c", change) == why
    assert not listed.no_test_can_notice("core_c/a.c", change)
