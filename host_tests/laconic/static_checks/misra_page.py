"""docs/misra.md: `python -m laconic.static_checks.misra_page` writes its table anew."""

from __future__ import annotations

import re

from laconic.paths import SOURCE_DIR
from laconic.progress import progress_bar
from laconic.static_checks.deviations import ANY, DEVIATIONS
from laconic.static_checks.misra import COLUMNS, Counts, all_findings, counted
from laconic.static_checks.parts import PARTS

PAGE = SOURCE_DIR / "docs" / "misra.md"
BEGIN, END = "<!-- table -->\n", "<!-- end of table -->\n"
ROW = re.compile(r"^\| (\d+\.\d+) \| \w+ \| (\S+) \| (\S+) \| (\S+) \|", re.MULTILINE)


def by_number(rule: str) -> tuple[int, ...]:
    """For sorting: 8.9 before 8.11."""
    return tuple(int(part) for part in rule.split("."))


def table(counts: Counts) -> str:
    """A row for each rule that is violated anywhere."""
    rows = ["| rule | category | core | node | FMU | reason |", "| --- | --- | --- | --- | --- | --- |"]
    for rule in sorted(counts, key=by_number):
        deviation = DEVIATIONS[rule]
        numbers = " | ".join(f"{counts[rule][column]}" for column in COLUMNS)
        rows.append(f"| {rule} | {deviation.category} | {numbers} | {deviation.reason} |")
    return "\n".join([*rows, ""])


def shown() -> Counts:
    """The counts that the page shows."""
    return counted((rule, {"core": "core_c/", "node": "firmware_stub/", "FMU": "fmu/"}[column], k)
                   for rule, *numbers in ROW.findall(PAGE.read_text(encoding="utf-8"))
                   for column, number in zip(COLUMNS, numbers, strict=True) for k in range(int(number)))


def differences(counts: Counts) -> str:
    """What to do where the page shows other counts; empty where it shows these."""
    return "" if shown() == counts else "shows older counts; renew it by `python -m laconic.static_checks.misra_page`"


def stale_rules() -> list[str]:
    """Deviations that are counted in no part of the page, and numbers of the page that no deviation allows."""
    counts = shown()
    unused = [f"{rule}: no place" for rule in DEVIATIONS if rule not in counts]
    over = [f"{rule}, {column}: {count}" for rule, by_column in counts.items() for column, count in by_column.items()
            if (most := DEVIATIONS[rule].most.get(column, 0)) != ANY and count > most]
    return unused + over


def main() -> None:
    """Writes the page's table."""
    with progress_bar("misra", sum(len(part.files()) for part in PARTS)) as advance:
        made = table(counted(all_findings(advance)))
    text = PAGE.read_text(encoding="utf-8")
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    PAGE.write_text(f"{before}{BEGIN}{made}{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
