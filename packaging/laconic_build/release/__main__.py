"""`python -m laconic_build.release`: collects what a build tree holds into a folder; the build gives the options."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from laconic_build.c.facts import facts, placeholders
from laconic_build.release.collect import Made, collect
from laconic_build.release.parts import Places
from laconic_build.release.tree import NoRelease, check_tools, tree_of
from laconic_fmu.licences import ziglang_in

MEGABYTE = 1e6


def main() -> int:
    """Status 2 with one line where no release can be made."""
    given = parse()
    try:
        check_tools(given.wasm_clang, given.cross)
        made = collect(tree_of(given.project), facts(), given.build, given.dist, places_of(given), compilers(given))
    except NoRelease as why:
        print(f"laconic: release: {why}", file=sys.stderr)
        return 2
    tell(made)
    return 0


def tell(made: Made) -> None:
    """The last lines: how much it is, and what is not as a release should be."""
    how = "`sha256sum -c SHA256SUMS` there checks them"
    print(f"{made.folder}: {made.count} files, {made.size / MEGABYTE:.1f} MB; {how}")
    if made.changed:
        print(f"not of a commit: {len(made.changed)} files differ from {made.commit[:12]}, {made.changed[0]} first")
    if missing := placeholders(facts()):
        print(f"placeholders in packaging/facts.json: {', '.join(missing)}; give real ones before this is published")


def compilers(given: argparse.Namespace) -> dict[str, str]:
    """First lines of what the compilers tell of themselves, by the names of what they made."""
    told = {"clang (WebAssembly)": (given.wasm_clang, "--version")}
    return {name: subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()[0]
            for name, words in told.items()}


def places_of(given: argparse.Namespace) -> Places:
    """Where the texts of licences are."""
    return Places(given.fmi_headers, given.wire, ziglang_in(given.cross), given.build / "site-python")


def parse() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="laconic_build.release", description=__doc__)
    for name, text in (("project", "the sources"), ("build", "the build tree"), ("dist", "where the release goes"),
                       ("wire", "the wire contract's C"), ("fmi-headers", "those of FMI"),
                       ("cross", "the environment that has ziglang")):
        parser.add_argument(f"--{name}", type=Path, required=True, help=f"folder: {text}")
    parser.add_argument("--wasm-clang", required=True, help="the compiler of the WebAssembly")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
