"""What the C tests reach, by file: lines, branches, and the conditions of decisions (MC/DC), in double and in single.

    coverage_table.py BUILD            of a build tree of clang >= 18 with -DLACONIC_COVERAGE=ON whose Unity tests ran
                                       (ctest --test-dir BUILD -L unity) prints the table; exit status 1 where more is
                                       missed than docs/assurance.md states
    coverage_table.py BUILD --write    writes the table into that page instead
    coverage_table.py BUILD --missed   prints each line, branch and condition that is missed
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/assurance.md"
PARTS = {"core": ("core_c/src", "core_c/optional/derivatives", "core_c/optional/filter", "core_c/optional/estimate"),
         "node": ("firmware_stub/node", "firmware_stub/wire"),
         "drives": ("firmware_stub/drives", *(f"firmware_stub/drives/{protocol}" for protocol in
                                              ("canopen", "moteus", "odrive", "robomaster"))),
         "commands": ("firmware_stub/secure",),
         "FMU": ("fmu", "fmu/vehicle"),
         "FMU, controller": ("fmu/controller",),
         "FMU, bus terminals": ("fmu/network", *(f"fmu/network/{model}" for model in ("node", "bus", "robomaster")))}
LEFT_OUT = ("shared_library", "library_drives")  # what Python alone calls
SCALARS = {"double": r"(test|node)_\w+_double|node_secure|fmu_unit_\w+",
           "single": r"(test|node)_\w+_single|node_secure"}
OTHER_MODELS = {"double": r"fmu_(derivatives|estimate|controller|node|bus|robomaster)_\w+", "single": ""}
"""Programs of the FMUs' glue around another model than the vehicle's: it is other code there where the model's macros
choose. LLVM knows each function once, so the programs of each model are looked at by themselves."""
CHOICE = re.compile(r"\bFMU_MODEL_(PORTS|KEEPS_STEPS|ESTIMATES|TAKES_SLOPES)\b")
KINDS = ("lines", "branches", "conditions")
MARK = re.compile(r"(a condition )?cannot be reached(?: in (double|single))?: \S")  # in a comment, the reason behind it
STALE = "is listed as what cannot be reached, and a test reaches it: take the comment out"
BEGIN, END = "<!-- coverage, made by cmake/coverage_table.py -->\n", "<!-- end of coverage -->\n"


def sources() -> list[str]:
    """The files whose coverage counts."""
    found = [path for folders in PARTS.values() for folder in folders
             for path in sorted((ROOT / folder).glob("*.[ch]"))]
    return [str(path) for path in found if path.stem not in LEFT_OUT]


def tool(name: str) -> str:
    """LLVM's tool of the newest version here."""
    for version in ("", *(f"-{number}" for number in range(25, 17, -1))):
        if path := shutil.which(name + version):
            said = subprocess.run([path, "--version"], capture_output=True, text=True, check=False).stdout
            number = re.search(r"version (\d+)", said)
            if number and int(number[1]) >= 18:
                return path
    sys.exit(f"coverage: needs {name} of LLVM 18 or newer; install the package llvm-19")


def report(build: Path, scalar: str) -> dict[str, list[dict]]:
    """By file: what llvm-cov says of all tests of a scalar type together, then of those around each other model."""
    found: dict[str, list[dict]] = {}
    for number, programs in enumerate(groups(build, scalar)):
        files = [path for path in sources() if number == 0 or part_of(path).startswith("FMU")]
        for file in export(build / "profiles", f"{scalar}_{number}", programs, files):
            found.setdefault(file["filename"], []).append(file)
    return found


def groups(build: Path, scalar: str) -> list[list[Path]]:
    """The test programs of a scalar type, and those around each other model."""
    every = sorted(path for folder in ("core_c/tests", "firmware_stub/tests", "fmu/tests/unit")
                   for path in (build / folder).glob("*") if path.is_file() and os.access(path, os.X_OK))
    first = [path for path in every if re.fullmatch(SCALARS[scalar], path.name)]
    if not first:
        sys.exit(f"coverage: {build} has no tests; build laconic_unity_tests with clang and -DLACONIC_COVERAGE=ON")
    others: dict[str, list[Path]] = {}
    for path in every:
        if told := re.fullmatch(OTHER_MODELS[scalar], path.name):
            others.setdefault(told[1], []).append(path)
    return [first, *others.values()]


def export(profiles: Path, name: str, programs: list[Path], files: list[str]) -> list[dict]:
    """These files, as llvm-cov reports on these programs."""
    raws = [profile_of(program, profiles) for program in programs]
    merged = profiles / f"{name}.profdata"
    subprocess.run([tool("llvm-profdata"), "merge", "-sparse", "-o", merged, *raws], check=True)
    objects = [word for program in programs[1:] for word in ("-object", str(program))]
    said = subprocess.run([tool("llvm-cov"), "export", "-format=text", f"-instr-profile={merged}", str(programs[0]),
                           *objects, "-sources", *files], capture_output=True, text=True, check=True).stdout
    return list(json.loads(said)["data"][0]["files"])


def profile_of(program: Path, profiles: Path) -> Path:
    """What a test of this program left; the test names it."""
    profile = profiles / f"{program.name}.profraw"
    if not profile.exists() or profile.stat().st_mtime < program.stat().st_mtime:
        sys.exit(f"coverage: {program.name} did not run since it was built; run ctest --test-dir "
                 f"{profiles.parent} -L unity")
    return profile


def listed(file: str, scalar: str) -> list[tuple[set[int], bool]]:
    """Lines of a file that say why they cannot be reached, of either scalar type or of this one: the comment stands in
    the line, or by itself in the line before. True where it speaks of conditions alone, not of the line's branches."""
    lines = Path(file).read_text(encoding="utf-8").splitlines()
    found = []
    for number, line in enumerate(lines, 1):
        told = MARK.search(line)
        if told and told[2] in (None, scalar):
            found.append(({number + line.strip().startswith("/*")}, told[1] is not None))
    return found


def missed(data: dict[str, list[dict]], scalar: str) -> dict[str, list[tuple[str, int, str]]]:
    """By kind: file, line and what of it no test reaches; without what the sources list. A function of a header counts
    once, whichever file it was reached from. A list of what is reached after all is missed itself."""
    found: dict[str, set] = {kind: set() for kind in KINDS}
    for name, reports in data.items():
        lines = uncovered_lines(reports) & lines_of_code(name)
        branches = {key for key, count in taken_branches(reports).items() if count == 0}
        hidden = hidden_of_all(name, reports)
        reasons, of_conditions = set(), set()
        for mark, of_conditions_alone in listed(name, scalar):
            undecided = {line for line, *_ in hidden}
            if of_conditions_alone:
                of_conditions |= mark
            else:
                reasons |= with_block(mark, lines)
                undecided |= lines | {line for line, *_ in branches}
            if not mark & undecided:
                found["lines"].add((name, min(mark), STALE))
        found["lines"] |= {(name, line, "line") for line in lines - reasons}
        found["branches"] |= {(name, line, f"column {column}, {side}") for line, column, side in branches
                              if line not in reasons}
        left = None if len(reports) > 1 else conditions_left(reports[0])
        found["conditions"] |= {(name, line, f"column {column}, condition {number}")
                                for line, column, number in hidden[:left] if line not in reasons | of_conditions}
    return {kind: sorted(each) for kind, each in found.items()}


def conditions_left(file: dict) -> int:
    """How many LLVM counts as missed."""
    return file["summary"]["mcdc"]["count"] - file["summary"]["mcdc"]["covered"]


def hidden_of_all(name: str, reports: list[dict]) -> list[tuple[int, int, int]]:
    """Conditions that no test shows, around whichever model. Those that a model's macros decide are none."""
    each = [hidden_conditions(file.get("mcdc_records", ()), known_conditions(file["branches"])) for file in reports]
    if len(each) == 1:
        return each[0]
    decided = conditions(name, reports)
    return sorted(key for key in decided
                  if all(key in hidden for hidden, file in zip(each, reports, strict=True) if has_decision(file, key)))


def has_decision(file: dict, key: tuple[int, int, int]) -> bool:
    """Whether the decision is in what these programs were made of."""
    return any((record[0], record[1]) == key[:2] for record in file.get("mcdc_records", ()))


def conditions(name: str, reports: list[dict]) -> set[tuple[int, int, int]]:
    """Line, column and number of each condition, but of those that a model's macros decide."""
    text = Path(name).read_text(encoding="utf-8").splitlines()
    of_code = lines_of_code(name)
    found = set()
    for file in reports:
        for line, column, end, end_column, *_, shown in file.get("mcdc_records", ()):
            words = [*text[line - 1:end - 1], text[end - 1][:end_column - 1]]
            words[0] = words[0][column - 1:]
            pieces = re.split(r"&&|\|\|", " ".join(words))
            chosen = [bool(CHOICE.search(piece)) for piece in pieces]
            if line in of_code:
                found |= {(line, column, number) for number in range(1, len(shown) + 1)
                          if len(pieces) != len(shown) or not chosen[number - 1]}
    return found


def with_block(mark: set[int], lines: set[int]) -> set[int]:
    """A line and the lines right behind it that no test runs."""
    block = set(mark)
    following = max(mark) + 1
    while following in lines:
        block.add(following)
        following += 1
    return block


def taken_branches(reports: list[dict]) -> Counter:
    """How often each side was taken. One whose condition the compiler knows has no counts and is left out."""
    found: Counter = Counter()
    for line, column, _, _, true, false, *_ in (branch for file in reports for branch in file["branches"]):
        if true or false:
            found[line, column, "true"] += true
            found[line, column, "false"] += false
    return found


def known_conditions(branches: list) -> set[tuple[int, int, int, int]]:
    """Where conditions stand that have no counts, since the compiler knows them, or since they were never asked: what
    made that so is then a side of another condition that was never taken."""
    asked: Counter = Counter()
    for line, column, end, end_column, true, false, *_ in branches:
        asked[line, column, end, end_column] += true + false
    return {place for place, count in asked.items() if count == 0}


def hidden_conditions(records: list, known: set[tuple[int, int, int, int]]) -> list[tuple[int, int, int]]:
    """Conditions that no test has shown to decide by themselves: line, column, number. Those that the compiler knows
    come last: they decide nothing, and LLVM's counts leave them out."""
    shown: dict[tuple[int, int, int], bool] = {}
    whole: Counter = Counter()
    last: set[tuple[int, int]] = set()
    for record in records:
        for number, is_shown in enumerate(record[-1], 1):
            key = (record[0], record[1], number)
            shown[key] = shown.get(key, False) or is_shown
            whole[record[0], record[1]] += is_shown
        if any((record[0], record[1]) <= place[:2] and place[2:] <= (record[2], record[3]) for place in known):
            last.add((record[0], record[1]))
    return sorted((key for key, is_shown in shown.items() if not is_shown),
                  key=lambda key: (key[:2] in last, whole[key[:2]] == 0, key))


def lines_of_code(file: str) -> set[int]:
    """Lines that are neither the preprocessor's nor a comment by itself."""
    found, goes_on = set(), False
    for number, line in enumerate(Path(file).read_text(encoding="utf-8").splitlines(), 1):
        is_directive = goes_on or line.lstrip().startswith("#")
        goes_on = is_directive and line.endswith("\\")
        if not is_directive and not (line.lstrip().startswith("/*") and line.rstrip().endswith("*/")):
            found.add(number)
    return found


def uncovered_lines(reports: list[dict]) -> set[int]:
    """Lines of which no region was ever run. Where a model leaves lines out, they look like a part of the region before
    them: they count only if a region begins there around another model."""
    best: Counter = Counter()
    seen: Counter = Counter()
    begun = {segment[0] for file in reports for segment in file["segments"] if segment[4]}
    for file in reports:
        for line, count in counts_of_lines(file["segments"]).items():
            best[line] = max(best[line], count)
            seen[line] += 1
    return {line for line, count in best.items() if count == 0 and (seen[line] == len(reports) or line in begun)}


def counts_of_lines(segments: list) -> dict[int, int]:
    """How often each line was run."""
    best: dict[int, int] = {}
    wrapped = None
    for segment, following in zip(segments, [*segments[1:], None], strict=True):
        line, _, count, has_count, is_entry, _ = segment
        if has_count and is_entry:
            best[line] = max(best.get(line, 0), count)
        if wrapped is not None and wrapped[3]:
            best[line] = max(best.get(line, 0), wrapped[2])
        wrapped = segment
        if has_count and following is not None:
            for between in range(line + 1, following[0]):
                best[between] = count
    return best


def totals(data: dict[str, list[dict]]) -> dict[str, Counter]:
    """How many there are, by part and kind."""
    found = {part: Counter() for part in PARTS}
    for name, reports in data.items():
        summaries = [file["summary"] for file in reports]
        several = len(reports) > 1
        found[part_of(name)].update(
            lines=max(each["lines"]["count"] for each in summaries),
            branches=len(taken_branches(reports)) if several else summaries[0]["branches"]["count"],
            conditions=len(conditions(name, reports)) if several else summaries[0]["mcdc"]["count"])
    return found


def part_of(file: str) -> str:
    """The part that a file is of."""
    folder = Path(file).relative_to(ROOT).parent.as_posix()
    return next(part for part, folders in PARTS.items() if folder in folders)


def table(data: dict[str, dict[str, list[dict]]]) -> list[str]:
    """Rows of the page's table: missed of how many."""
    rows = [f"| part, scalar | {' | '.join(KINDS)} |", f"|{' --- |' * (1 + len(KINDS))}"]
    for scalar, each in data.items():
        count, gaps = totals(each), missed(each, scalar)
        for part in PARTS:
            if count[part]:
                left = {kind: sum(part_of(file) == part for file, _, _ in gaps[kind]) for kind in KINDS}
                cells = [f"{count[part][kind] - left[kind]} of {count[part][kind]}" for kind in KINDS]
                rows.append(f"| {part}, {scalar} | {' | '.join(cells)} |")
    return rows


def gaps_of(rows: list[str]) -> dict[tuple[str, str], int]:
    """How many each cell misses."""
    found = {}
    for row in rows[2:]:
        name, *cells = [cell.strip() for cell in row.strip("|").split("|")]
        for kind, cell in zip(KINDS, cells, strict=True):
            reached, _, there = cell.partition(" of ")
            found[name, kind] = int(there) - int(reached)
    return found


def main(build: str, *options: str) -> int:
    data = {scalar: report(Path(build).resolve(), scalar) for scalar in SCALARS}
    if "--missed" in options:
        for scalar, each in data.items():
            for kind, gaps in missed(each, scalar).items():
                for file, line, what in gaps:
                    print(f"{Path(file).relative_to(ROOT)}:{line}: {scalar}, {kind}: {what}")
    rows = table(data)
    print("\n".join(rows))
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    stated, _, after = rest.partition(END)
    if "--write" in options:
        PAGE.write_text(before + BEGIN + "\n" + "\n".join(rows) + "\n\n" + END + after, encoding="utf-8")
        return 0
    bound = gaps_of(stated.strip().splitlines())
    stale = [(file, line) for scalar, each in data.items() for file, line, what in missed(each, scalar)["lines"]
             if what == STALE]
    for file, line in stale:
        print(f"coverage: {Path(file).relative_to(ROOT)}:{line}: {STALE}")
    worse = {cell: gap for cell, gap in gaps_of(rows).items() if gap > bound.get(cell, 0)}
    for (name, kind), gap in worse.items():
        print(f"coverage: {name}: {gap} {kind} are missed, and docs/assurance.md states {bound.get((name, kind), 0)}; "
              "--missed names them")
    return 1 if worse or stale else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
