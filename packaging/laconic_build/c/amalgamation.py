"""The core as two files: laconic.h is every public header, laconic.c every source file, each after what it includes.
Of the optional parts they have those of OPTIONAL.

The files are compiled as one, so names that a source file keeps for itself must differ between files; its macros end
with it. A second pair has the prefix laconic_single_ and is always float, so that one program can hold both.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from laconic_build.c.facts import CORE, Facts

INCLUDE = re.compile(r'^#include (?:<(?P<system>\w+\.h)>|"(?:laconic/)?(?P<own>\w+\.h)").*\n', re.MULTILINE)
MACRO = re.compile(r"^#define (\w+)", re.MULTILINE)
OPTIONAL = {"articulated": "articulated.h"}
"""Folders of core_c/optional that are in the files, and their public headers."""
CHECKED = re.compile(r"^#define (laconic_\w+)\(", re.MULTILINE)

HEADER_HEAD = """\
/* Laconic {version}. {sentence}
 *
 * One of two files, made from the sources of the project: {name}.h and {name}.c. Compile {name}.c with your program, as
 * C (C99 or newer) or C++ (C++11 or newer). It needs no other file, no library and no option:
 *
 *     cc -O2 program.c {name}.c
 *
{reals} *
 * -ffunction-sections -fdata-sections, and -Wl,--gc-sections when linking, leave out what a program does not call.
 * laconic_self_test(), called when a program starts, tells whether its numbers will be those of every other platform,
 * to the last bit.
 *
{licence} */
"""

PLAIN_REALS = """\
 * -DLACONIC_SINGLE, for all files that see laconic.h, makes all numbers float instead of double. For a program with
 * both there is the pair laconic_single.h and laconic_single.c, with names of its own.
"""

SINGLE_REALS = """\
 * All numbers are float. All names begin with laconic_single_ or LACONIC_SINGLE_ where laconic.h has laconic_ or
 * LACONIC_, so that a program can hold both pairs.
"""

SOURCE_HEAD = """\
/* Laconic {version}. How to compile it, and the licence: {name}.h. */
#define {prefix}_IN_CORE /* no check of a program's definitions here */
{hidden}#include "{name}.h"
{checked}
/* Every operation is rounded once, whatever the options say of fused multiply-add. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC push_options
#pragma GCC optimize("fp-contract=off", "no-tree-slp-vectorize")
#elif defined(_MSC_VER)
#pragma fp_contract(off)
#endif
"""

HIDDEN = """\
/* Two builds in one process, such as two plugins, must not call each other's functions: one with unusual definitions
 * exports no names from a shared library, unless {prefix}_EXPORTED is defined. */
#if defined(__ELF__) && defined(__PIC__) && !defined({prefix}_EXPORTED) && \\
    ({unusual})
#define {prefix}_IS_HIDDEN
#pragma GCC visibility push(hidden)
#endif
"""

SOURCE_FOOT = """
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif
#ifdef {prefix}_IS_HIDDEN
#pragma GCC visibility pop
#undef {prefix}_IS_HIDDEN
#endif
"""


def amalgamation(facts: Facts) -> dict[str, str]:
    """The names of the four files and their texts."""
    header, source = public_headers(), all_sources()
    single = "#define LACONIC_SINGLE_SINGLE /* float, in each place that chooses the scalar type */\n" + renamed(header)
    return {
        "laconic.h": header_head(facts, "laconic", PLAIN_REALS) + header,
        "laconic.c": whole(facts, "laconic", header, source),
        "laconic_single.h": header_head(facts, "laconic_single", SINGLE_REALS) + single,
        "laconic_single.c": whole(facts, "laconic_single", single, renamed(source)),
    }


def header_head(facts: Facts, name: str, reals: str) -> str:
    licence = "".join(f" * {line}".rstrip() + "\n" for line in facts.licence.splitlines())
    return HEADER_HEAD.format(version=facts.version, sentence=facts.sentence, name=name, reals=reals, licence=licence)


def whole(facts: Facts, name: str, header: str, source: str) -> str:
    """The source file. A program may include it, also behind the header."""
    prefix, checked = name.upper(), undefined(CHECKED.findall(header))
    hidden = HIDDEN.format(prefix=prefix, unusual=" || \\\n     ".join(unusual_definitions(prefix)))
    head = SOURCE_HEAD.format(version=facts.version, name=name, prefix=prefix, checked=checked, hidden=hidden)
    return head + source + SOURCE_FOOT.format(prefix=prefix)


def unusual_definitions(prefix: str) -> list[str]:
    """Conditions that a definition of real.h is not the usual one. The second pair is always float, and has names of
    its own."""
    real = (CORE / "include" / "laconic" / "real.h").read_text("utf-8")
    usual = re.findall(r"^#ifndef (LACONIC_\w+).*\n#define \1 (\d+)$", real, re.MULTILINE)
    own = [(name.replace("LACONIC", prefix), value) for name, value in usual]
    switches = ["LACONIC_SINGLE"] if prefix == "LACONIC" else []
    return [f"defined({name})" for name in [*switches, f"{prefix}_SCENE_HEADER"]] + [
        f"(defined({name}) && {name} != {value})" for name, value in own]


def public_headers() -> str:
    headers = {path.name: path for path in (CORE / "include" / "laconic").glob("*.h")}
    seen, system = set[str](), set[str]()
    return "".join(flat(headers[name], headers, seen, system) for name in ("laconic.h", *OPTIONAL.values()))


def all_sources() -> str:
    public = (CORE / "include" / "laconic").glob("*.h")  # fields.c includes one that laconic.h does not
    own = [CORE / "src", *(CORE / "optional" / folder for folder in OPTIONAL)]
    sources = {path.name: path for path in (*public, *sorted(each for root in own for each in root.rglob("*.[ch]")))}
    seen, system = {"laconic.h", *OPTIONAL.values()}, set[str]()
    parts = [part_of(sources[name], sources, seen, system) for name in sorted(sources) if name.endswith(".c")]
    shared = sorted({name for path in sources.values() if path.suffix == ".h" for name in macros(path)})
    return "".join(parts) + banner("end") + undefined(shared)


def part_of(path: Path, files: Mapping[str, Path], seen: set[str], system: set[str]) -> str:
    return banner(path.name) + flat(path, files, seen, system) + undefined(macros(path))


def flat(path: Path, files: Mapping[str, Path], seen: set[str], system: set[str]) -> str:
    """Returns a file with each file that it includes in the place of the first #include of it."""
    seen.add(path.name)

    def once(found: re.Match[str]) -> str:
        name, known = (found["own"], seen) if found["own"] else (found["system"], system)
        if name in known:
            return ""
        known.add(name)
        return flat(files[name], files, seen, system) if found["own"] else found[0]

    return INCLUDE.sub(once, path.read_text(encoding="utf-8"))


def macros(path: Path) -> list[str]:
    """Names of the macros of a file, each once, without a header's guard."""
    text = path.read_text(encoding="utf-8")
    return list(dict.fromkeys(name for name in MACRO.findall(text) if not name.endswith("_H")))


def undefined(names: list[str]) -> str:
    return "".join(f"#undef {name}\n" for name in names)


def banner(text: str) -> str:
    return f"\n/* {f' {text} ':=^112} */\n\n"


def renamed(text: str) -> str:
    return text.replace("laconic_", "laconic_single_").replace("LACONIC_", "LACONIC_SINGLE_")
