"""The proof's arguments belong to lines that are there, an alarm without one is noticed, a row says of which sources it
is, and every public function is followed by an entry or is listed with a reason."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from laconic.paths import SOURCE_DIR
from laconic.soak.proof import chosen
from laconic.static_checks import contracts, proved
from laconic.static_checks.contracts import ROOMS, contracts_in, goals_of
from laconic.static_checks.discharged import DISCHARGED
from laconic.static_checks.frama_c import (
    CORE,
    ESTIMATES,
    FRAMES,
    NODE,
    PLANTS,
    PROGRAMS,
    Program,
    alarms_of,
    analysis_of,
    prove,
)
from laconic.static_checks.proof_page import PAGE, shown, tables
from laconic.static_checks.proved import Row, digest_of, files_read, keep, options_of_row, read_kept, wanted
from laconic.static_checks.public_functions import (
    HEADERS,
    WITHOUT,
    WITHOUT_HEADERS,
    covered_by,
    public_functions,
    reason_without,
)

PRINTED = """\
[eva:alarm] core_c/src/vector.h:17: Warning:
  accessing uninitialized left-value. assert \\initialized(v + 0);
[eva] Recording results for vec
[eva:alarm] core_c/src/vector.h:17: Warning:
  accessing out of bounds index. assert k < 3;
[eva:alarm] core_c/src/step.c:90: Warning:
  function check_many: postcondition got status unknown.
[eva:alarm] firmware_stub/src/e2e.c:99: Warning:
  function stray: precondition receiver->stray_count < 3 got status unknown.
[eva:summary] ====== ANALYSIS SUMMARY ======
[metrics] Statements analyzed by Eva
  --------------------------
  387 stmts in analyzed functions, 386 stmts analyzed (99.7%)
  vec: 15 stmts out of 15 (100.0%)
  put_0: 12 stmts out of 12 (100.0%)
"""
UNSOUND = """\
static int numbers[3];
void prove_made_up(void);
void prove_made_up(void) { for (int k = 0; k <= 3; k++) numbers[k] = k; }
"""
WRONG = """\
/*@ assigns \\nothing;
    ensures larger: \\result > x;
    ensures not_smaller: \\result >= \\min(x, 4); */
int made_up(int x) { return x < 5 ? x + 1 : x; }
"""
ROW = Row("eva", "core", "rk4", "2026-11-23", 9, "", ["core_c/src/rk4.c"], functions=["laconic_step"])
OF_ROW = options_of_row("eva", "core", "rk4")
needs_frama_c = pytest.mark.skipif(shutil.which("frama-c") is None, reason="Frama-C is not installed")


def test_each_argument_is_about_a_line_that_is_there():
    for argument in DISCHARGED:
        assert argument.part in (SOURCE_DIR / argument.file).read_text(encoding="utf-8"), argument
        assert set(argument.entries) <= {entry for program in PROGRAMS for entry in program.entries()}, argument


def test_an_alarm_of_another_kind_or_of_another_entry_at_the_same_line_is_open():
    unset, index, granted = alarms_of("prove_rk4", PRINTED)
    assert unset.discharged and not index.discharged and not granted.discharged
    assert str(index).startswith("core_c/src/vector.h:17: accessing out of bounds index")
    assert not alarms_of("prove_texts", PRINTED)[0].discharged


def test_functions_and_statements_that_were_followed_are_read():
    found = analysis_of("prove_rk4", PRINTED)
    assert (found.functions, found.statements, found.reached) == (["put_0", "vec"], 387, 386)


def test_the_page_shows_what_was_kept():
    text = PAGE.read_text(encoding="utf-8")
    for name, table in tables(read_kept()).items():
        assert shown(name, text) == table, f"renew it by `python -m laconic.static_checks.proof_page`: {name}"


def test_no_proof_that_was_kept_is_open():
    rows = read_kept()
    assert set(rows) == set(wanted()), "run `laconic soak proof`"
    assert [key for key, row in rows.items() if not row.holds] == []


def test_the_page_says_which_proofs_are_of_older_sources():
    rows = read_kept()
    changed = {key: replace(row, digest="of before") if key == "eva core: rk4" else row for key, row in rows.items()}
    assert "of older sources" in next(line for line in tables(changed)["entries"].splitlines() if "`rk4`" in line)
    made = tables(rows)
    lines = (made["entries"] + made["contracts"]).splitlines()
    older = [key for key, row in rows.items() if not row.is_of_these_sources()]
    assert sum("of older sources" in line for line in lines) == len(older)


def test_every_public_function_is_followed_by_an_entry_or_is_listed_with_a_reason():
    followed = covered_by(read_kept().values())
    for header in HEADERS:
        for name in public_functions(header):
            assert bool(followed.get(name)) != bool(reason_without(header, name)), f"{header}: {name}"
    assert set(WITHOUT) <= {name for header in HEADERS for name in public_functions(header)}
    assert set(WITHOUT_HEADERS) <= set(HEADERS)


def test_what_a_harness_stands_in_for_counts_as_followed_by_others_alone():
    row = replace(ROW, part="node, on frames", name="frames", functions=["laconic_plant_run", "laconic_node_on_tick"])
    assert covered_by([row]) == {"laconic_node_on_tick": ["frames"]}
    assert {"laconic_plant_run", "laconic_loader_check", "laconic_sensors_start"} <= FRAMES.stand_ins()
    assert CORE.stand_ins() == set()
    assert PLANTS.stand_ins() == ESTIMATES.stand_ins() == {"laconic_friction_step"}


def test_headers_are_read_whole():
    found = {name for header in HEADERS for name in public_functions(header)}
    assert {"laconic_step", "laconic_mix", "laconic_field_traits_of", "laconic_e2e_accepts"} <= found
    assert len(found) > 190


def test_a_row_is_older_as_soon_as_a_source_that_it_read_changes(tmp_path: Path, monkeypatch):
    source = tmp_path / "a.c"
    monkeypatch.setattr(proved, "SOURCE_DIR", tmp_path)
    digests = []
    for text in ("int a; /* one */\n", "int  a; // two\n", "int a; /*@ assigns \\nothing; */\n", "int b;\n"):
        source.write_text(text, encoding="utf-8")
        proved._text.cache_clear()
        proved._bare.cache_clear()
        digests.append(digest_of(["a.c"], OF_ROW))
    assert digests[0] == digests[1] and len(set(digests)) == 3
    assert replace(ROW, files=["a.c"], digest=digests[3]).is_of_these_sources()
    assert not replace(ROW, files=["a.c"], digest=digests[0]).is_of_these_sources()


@pytest.mark.parametrize("tool,part,name", [("eva", "core", "rk4"), ("wp", "core", "states")])
def test_a_row_is_older_as_soon_as_an_option_of_frama_c_changes(tool: str, part: str, name: str, monkeypatch):
    row = replace(ROW, tool=tool, part=part, name=name)
    row = replace(row, digest=digest_of(row.files, options_of_row(tool, part, name)))
    assert row.is_of_these_sources()
    monkeypatch.setattr("laconic.static_checks.frama_c.OPTIONS", ("-eva-precision", "0"))
    monkeypatch.setattr("laconic.static_checks.contracts.PROVERS", ("-wp-prover", "z3"))
    assert not row.is_of_these_sources()


def test_the_place_of_the_build_is_no_option(monkeypatch, tmp_path: Path):
    before = options_of_row("eva", "node", "loader")
    monkeypatch.setenv("LACONIC_BUILD_DIR", str(tmp_path))
    assert options_of_row("eva", "node", "loader") == before


def test_an_entry_has_read_the_files_of_the_functions_that_it_followed_with_their_headers():
    files = files_read(CORE.files(), ["rk4_step", "prove_rk4"], CORE)
    assert {"core_c/src/rk4.c", "core_c/src/heading.h", "core_c/include/laconic/laconic.h", "core_c/proof/core.c"} <= {
        *files}
    assert "core_c/src/message.c" not in files
    assert "firmware_stub/laconic.dbc" in files_read(NODE.files(), ["laconic_loader_take"], NODE)


def test_rows_are_kept_by_proof_and_only_changed_ones_are_run_again(tmp_path: Path, monkeypatch):
    kept = tmp_path / "proved.json"
    keep(replace(ROW, digest="old"), kept)
    keep(replace(ROW, digest=digest_of(ROW.files, OF_ROW)), kept)
    assert [row.key for row in read_kept(kept).values()] == ["eva core: rk4"]
    monkeypatch.setattr("laconic.soak.proof.read_kept", lambda: read_kept(kept))
    assert "eva core: rk4" not in chosen(None) and "eva core: texts" in chosen(None)
    assert chosen("slcan") == ["eva node: slcan", "wp node: slcan"]


def test_every_contract_of_the_sources_is_proved_in_a_room():
    in_rooms = {function for room in ROOMS for function in room.functions}
    for folder in ("core_c/src", "core_c/derivatives", "core_c/filter", "firmware_stub/src", "firmware_stub/secure"):
        for path in sorted((SOURCE_DIR / folder).glob("*.[ch]")):
            assert set(contracts_in(path.read_text(encoding="utf-8"))) <= in_rooms, path


BOXES = {
    "any_vehicle": """ANYTHING(vehicle);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        vehicle.wheel[i].locked = ANY_BOOL();
        vehicle.wheel[i].undriven = ANY_BOOL();
    }""",
    "countable_vehicle": """any_vehicle();
    vehicle.wheel_count = Frama_C_interval(0, LACONIC_MAX_WHEELS);
    vehicle.support_count = Frama_C_interval(0, LACONIC_MAX_SUPPORTS);""",
    "any_state": """ANYTHING(state);
    state.heading.turns = Frama_C_long_long_interval(-MOST_TURNS - 1, MOST_TURNS);""",
    "any_inputs": "ANYTHING(input);",
}


def test_the_boxes_narrow_no_number_that_the_checks_let_pass():
    paths = sorted((SOURCE_DIR / "core_c/proof").rglob("*.[ch]"))
    harness = "".join(path.read_text(encoding="utf-8") for path in paths)
    for name, body in BOXES.items():  # to the letter, so that what the page says of a box is what it is
        assert re.findall(rf"void {name}\(void\) {{\s+(.*?)\s*}}\n\n", harness, re.DOTALL) == [body], name
    assert "#define ANYTHING(thing) Frama_C_make_unknown((char *)&(thing), sizeof(thing))\n" in harness
    assert re.findall(r"\*(?: const)? ?\w+ = &(?:vehicle|input|start|state)\b.*", harness) == []  # by another name
    narrowed = set(re.findall(r"(?<![\w.>])((?:vehicle|input|start)\b[.\[][^=;()]*?) = ", harness))
    assert narrowed == {"vehicle.wheel[i].locked", "vehicle.wheel[i].undriven", "vehicle.wheel_count",
                        "vehicle.support_count"}
    check = (SOURCE_DIR / "core_c/src/vehicle.c").read_text(encoding="utf-8")
    for count, most in (("wheel_count", "LACONIC_MAX_WHEELS"), ("support_count", "LACONIC_MAX_SUPPORTS")):
        assert re.search(rf"(\w+)->{count} < 0 \|\| \1->{count} > {most}\)", check)
        assert f"vehicle.{count} = Frama_C_interval(0, {most});" in harness


def test_a_row_is_open_as_soon_as_the_argument_of_an_alarm_is_gone(monkeypatch):
    row = next(row for row in read_kept().values() if row.key == "eva core: steps_in")
    assert row.alarms and row.holds
    monkeypatch.setattr("laconic.static_checks.frama_c.DISCHARGED", ())
    assert len(row.open) == len(row.alarms) and not row.holds


def test_goals_that_no_prover_closed_are_open():
    printed = "[wp] [Failed] Goal typed_a_ensures\n  Z3: Unknown\n[wp] Proved goals:   12 / 14\n"
    assert goals_of("room", printed).open == ["typed_a_ensures", "room: not named by WP"]


@needs_frama_c
def test_an_index_beyond_its_array_is_an_open_alarm(tmp_path: Path):
    harness = tmp_path / "made_up.c"
    harness.write_text(UNSOUND, encoding="utf-8")
    found = prove(MadeUp("made up", str(harness), (), ()), "prove_made_up", limit_s=120.0)
    assert [alarm.discharged for alarm in found.alarms] == [False]
    assert "out of bounds index" in found.alarms[0].what and found.functions == ["prove_made_up"]


@pytest.mark.skipif(any(shutil.which(tool) is None for tool in ("frama-c", "why3", "z3", "cvc4")),
                    reason="Frama-C or a prover is not installed")
def test_a_contract_that_does_not_hold_is_an_open_goal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    two_seconds = (*contracts.PROVERS, "-wp-timeout", "2")  # no prover ends on what is wrong; the rest takes less
    monkeypatch.setattr("laconic.static_checks.contracts.PROVERS", two_seconds)
    source = tmp_path / "made_up.c"
    source.write_text(WRONG, encoding="utf-8")
    room = contracts.Room("made up", CORE, (str(source),), ("made_up",))
    found = contracts.prove_contracts(room, limit_s=120.0)
    assert found.open == ["typed_made_up_ensures_larger"] and found.count > 2


class MadeUp(Program):
    """Its harness lies anywhere."""

    def entries(self) -> dict[str, str]:
        """The one entry."""
        return {"prove_made_up": self.harnesses}
