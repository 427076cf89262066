"""Which faults the operators make, and that a list of equivalents finds its mutants by text."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

from laconic.errors import BadInput
from laconic.mutation import mutants_of, read_equivalents
from laconic.mutation.campaign import PARTS, files_of
from laconic.mutation.equivalent import read_laws
from laconic.paths import SOURCE_DIR

SOURCE = """\
#define HALF 0.5 /* 1/2 */
INLINE int sum(int a, int b) {
    int list[3] = {0};
    for (int k = 0; k < 2; k++) list[k] += a * b; /* k < 9 */
    if (!a && b >= 1e-3f) f(a, b);
    return list[1];
}
"""


def changes(tmp_path: Path, text: str = SOURCE) -> set[tuple[str, str]]:
    (tmp_path / "a.c").write_text(text)
    source = (tmp_path / "a.c").read_bytes()
    found = set()
    for mutant in mutants_of(tmp_path, "a.c"):
        assert mutant.applied_to(source) != source and mutant.before != mutant.after
        found.add((source[mutant.start:mutant.end].decode(), mutant.text))
    return found


def test_each_operator_makes_its_faults(tmp_path):
    found = changes(tmp_path)
    assert {("<", "<="), ("<", ">="), (">=", ">"), (">=", "<")} <= found             # relational
    assert {("*", "/"), ("+=", "-="), ("++", "--")} <= found                           # arithmetic
    assert {("&&", "||"), ("!", "")} <= found                                          # logical
    assert {("2", "3"), ("2", "1"), ("0.5", "0.505"), ("1e-3f", "0.01f")} <= found     # constants
    assert ("(!a && b >= 1e-3f)", "(!((!a && b >= 1e-3f)))") in found                   # conditions
    assert ("f(a, b);", ";") in found                                                  # statements
    assert ("a, b", "b, a") in found                                                   # arguments


def test_what_makes_functions_is_not_left_out(tmp_path):
    found = changes(tmp_path, "MAKES(f, int)\nMAKES(g, float);\nint h(void) { MAKES(i); return 2; }\n")
    assert [old for old, new in found if new == ";"] == ["MAKES(i);"]


def test_comments_have_none_and_an_array_only_becomes_shorter(tmp_path):
    found = changes(tmp_path)
    assert not any("9" in old for old, _ in found)
    assert ("3", "2") in found and ("3", "4") not in found


def test_a_mutant_knows_its_function_behind_the_projects_own_words(tmp_path):
    (tmp_path / "a.c").write_text(SOURCE)
    assert {mutant.function for mutant in mutants_of(tmp_path, "a.c")} == {"", "sum"}


def test_the_same_change_twice_in_a_line_is_two_mutants_and_a_moved_line_none_new(tmp_path):
    text = "int f(int a) { return a + a + a; }\n"
    (tmp_path / "a.c").write_text(text)
    keys = [mutant.key for mutant in mutants_of(tmp_path, "a.c")]
    assert len(keys) == 2 == len(set(keys))
    (tmp_path / "a.c").write_text(f"/* more */\n\n{text}")
    assert [mutant.key for mutant in mutants_of(tmp_path, "a.c")] == keys


def test_every_row_of_the_list_of_equivalents_fits_its_source_and_stands_once():
    rows = read_equivalents()
    assert len(rows) > 200
    for file in {row.file for row in rows}:
        text = (SOURCE_DIR / file).read_text(encoding="utf-8")
        lines = [" ".join(re.sub(r"/\*.*?(\*/|$)", "", line).split()) for line in text.splitlines()]
        there = {" ".join(lines[first:first + count]) for count in range(1, 7) for first in range(len(lines))}
        places = {(each.function, each.before) for each in mutants_of(SOURCE_DIR, file)}
        for row in (each for each in rows if each.file == file):
            home = re.search(rf"\b{row.function}\(|struct {row.function} {{", text)
            is_there = (row.function, row.before) in places or (row.before in there and home is not None)
            assert is_there and row.after != row.before, row
    faults = Counter((row.file, row.function, row.before, row.after) for row in rows)
    assert [fault for fault, times in faults.items() if times > 1] == []


@pytest.mark.parametrize("row", [
    'function = "f"\nbefore = "x"\nafter = ["y"]\nreason = " "', 'function = "f"\nbefore = "x"\nafter = ["y"]',
    'function = "f"\nbefore = "x"\nafter = "y"\nreason = "z"', 'function = "f"\nbefore = "x"\nafter = []\nreason = "z"',
    'function = "f"\nbefore = "x"\nafter = ["y", 1]\nreason = "z"', 'function = "f"\nbefore = "x"\nafter = ["y"]\n'
    'reason = "z"\nfile = "a.c"'])
def test_a_row_that_is_not_complete_is_refused(tmp_path, row):
    (tmp_path / "a.c.toml").write_text(f"[[equivalent]]\n{row}\n")
    with pytest.raises(BadInput, match=r"a\.c\.toml: row 1: needs .*reason"):
        read_equivalents(tmp_path)


def test_core_node_and_fmu_are_the_parts_and_what_python_alone_calls_is_in_neither():
    assert "core_c/src/rk4.c" in files_of("core") and "firmware_stub/src/node.c" in files_of("node")
    assert "firmware_stub/drives/canopen/sdo.c" in files_of("drives")
    assert set(files_of("commands")) == {f"firmware_stub/secure/{name}.c" for name in ("aes", "cmac", "gate", "secoc")}
    assert set(files_of(None)) == {file for part in PARTS for file in files_of(part)}
    assert not any("library" in Path(file).name for file in files_of(None))


def test_what_the_laws_speak_of_is_there_and_functions_that_commute_take_arguments_of_a_kind():
    text = "\n".join((SOURCE_DIR / file).read_text(encoding="utf-8") for part in PARTS for file in files_of(part))
    headers = "\n".join(path.read_text(encoding="utf-8") for path in (SOURCE_DIR / "core_c/include").rglob("*.h"))
    laws = read_laws()
    assert laws.keys() == {"commutative_functions", "counts", "setting_functions"}
    for name in laws["setting_functions"] - {"memcpy", "memset"}:
        assert re.search(rf"\bvoid {name}\(", text), name
    assert re.search(r"#define BOTH\(a, b\) \(\(a\) && \(b\)\)", text)
    for name in laws["commutative_functions"] - {"BOTH"}:
        assert re.search(rf"\b{name}\((const )?(\w+) \w+(, (const )?\2 \w+)+\) \{{", text), name
    for name in laws["counts"]:
        assert re.search(rf"\bu?int\d+_t ([\w, ]+, )?{name}[,;]", headers), name
