"""docs/proof.md: `python -m laconic.static_checks.proof_page` writes its tables anew: what each proof gave last, which
public functions have an entry, and why alarms cannot happen."""

from __future__ import annotations

from laconic.paths import SOURCE_DIR
from laconic.static_checks.discharged import DISCHARGED
from laconic.static_checks.proved import Row, read_kept, wanted
from laconic.static_checks.public_functions import HEADERS, covered_by, public_functions, reason_without

PAGE = SOURCE_DIR / "docs" / "proof.md"


def tables(rows: dict[str, Row]) -> dict[str, str]:
    """The page's tables by name."""
    return {"entries": entries_table(rows), "contracts": contracts_table(rows), "functions": functions_table(rows),
            "arguments": arguments_table()}


def entries_table(rows: dict[str, Row]) -> str:
    """What the analyser found for each entry."""
    lines = ["| part | entry | functions | statements reached | alarms | not justified | s | run |",
             "| --- | --- | --- | --- | --- | --- | --- | --- |"]
    for key in wanted():
        row = rows.get(key)
        part, name = key.removeprefix("eva ").split(": ")
        if not key.startswith("eva "):
            continue
        if row is None or row.failed:
            lines.append(f"| {part} | `{name}` | | | | {'did not end' if row else 'not run'} | | |")
        else:
            reached = f"{row.reached} of {row.statements}"
            alarms = f"{len(row.alarms)} | {len(row.open)}"
            lines.append(f"| {part} | `{name}` | {len(row.functions)} | {reached} | {alarms} | {row.seconds} "
                         f"| {run_of(row)} |")
    return _joined(lines)


def contracts_table(rows: dict[str, Row]) -> str:
    """What WP proved in each room."""
    lines = ["| part | room | contracts of | goals | open | s | run |", "| --- | --- | --- | --- | --- | --- | --- |"]
    for key in wanted():
        row = rows.get(key)
        part, name = key.removeprefix("wp ").split(": ")
        if not key.startswith("wp "):
            continue
        if row is None or row.failed:
            lines.append(f"| {part} | `{name}` | | | {'did not end' if row else 'not run'} | | |")
        else:
            names = ", ".join(f"`{function}`" for function in row.functions)
            lines.append(f"| {part} | `{name}` | {names} | {row.goals} | {len(row.open)} | {row.seconds} "
                         f"| {run_of(row)} |")
    return _joined(lines)


def run_of(row: Row) -> str:
    """When a proof ran, and whether its sources have changed since."""
    return row.ended if row.is_of_these_sources() else f"{row.ended}, of older sources"


def functions_table(rows: dict[str, Row]) -> str:
    """Of each header the functions that entries follow, and those that none follows."""
    followed = covered_by(rows.values())
    lines = ["| header | followed by an entry without open alarms | by none | why not |", "| --- | --- | --- | --- |"]
    for header in HEADERS:
        names = public_functions(header)
        with_entry = [f"`{name}`" for name in names if followed.get(name)]
        without = [f"`{name}`" for name in names if not followed.get(name)]
        reasons = dict.fromkeys(reason_without(header, name) for name in names if not followed.get(name))
        if names:
            lines.append(f"| `{header}` | {', '.join(with_entry) or '–'} | {', '.join(without) or '–'} "
                         f"| {'; '.join(reasons)} |")
    return _joined(lines)


def arguments_table() -> str:
    """Each argument with its place."""
    lines = ["| file | line | why it cannot happen |", "| --- | --- | --- |"]
    lines += [f"| `{each.file}` | `{each.part}` | {each.why} |" for each in DISCHARGED]
    return _joined(lines)


def _joined(lines: list[str]) -> str:
    return "\n".join([*lines, ""])


def shown(name: str, text: str) -> str:
    """One table of the page's text."""
    return text.split(f"<!-- {name} -->\n")[1].split(f"<!-- end of {name} -->\n")[0]


def page_with(made: dict[str, str], text: str) -> str:
    """The page with these tables."""
    for name, table in made.items():
        before, after = text.split(f"<!-- {name} -->\n")[0], text.split(f"<!-- end of {name} -->\n")[1]
        text = f"{before}<!-- {name} -->\n{table}<!-- end of {name} -->\n{after}"
    return text


def write_page() -> None:
    """Writes the page's tables."""
    PAGE.write_text(page_with(tables(read_kept()), PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    write_page()
