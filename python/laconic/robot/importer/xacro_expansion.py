"""xacro files, expanded by the library `xacro`, bounded in time and memory: their expressions may compute anything."""

from __future__ import annotations

import re
import sys
import types
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any
from xml.parsers.expat import ExpatError

from laconic.errors import BadInput, nearest_of, reason_of
from laconic.robot.importer.bounded import Library, bounded
from laconic.robot.importer.checked import WORDS_AT_MOST
from laconic.robot.importer.meshes import MeshFiles
from laconic.robot.importer.xml_file import Element, xml_root

MACRO, INCLUDE = "xacro:macro", "xacro:include"
XACRO = Library("xacro", "the expression, macro or include that goes on for ever")


def expanded(path: Path, arguments: Mapping[str, str], packages: Mapping[str, Path]) -> str:
    """The URDF of a xacro file with `NAME:=VALUE` arguments; $(find NAME) looks beside and above the file."""
    text: str = bounded(XACRO, _expand, path, dict(arguments), dict(packages))
    return text


def _expand(path: Path, arguments: dict[str, str], packages: dict[str, Path]) -> str:
    import xacro

    files, given = MeshFiles(path, packages), _Asked(arguments)
    _answer_for_ros(files)
    _keep_texts_of_yaml()
    try:
        text = str(xacro.process_file(str(path), mappings=given).toxml())
    except Exception as error:
        causes = _causes(error)
        if any(isinstance(each, MemoryError) for each in causes):
            raise MemoryError from None
        if name := files.asked_for:
            raise BadInput(f"{path}: package {name} is not beside or above the file; give --package {name}=FOLDER"
                           ) from None
        if any(isinstance(each, RecursionError) for each in causes):
            raise BadInput(f"{path}: xacro cannot expand it: a macro calls, or a file includes, itself without end; "
                           "mend it") from None
        check_is_robot(path, None)
        raise BadInput(f"{path}: xacro cannot expand it: {_words(causes)}{_place(path, causes)}") from None
    for name in arguments:
        if name not in given.names:
            raise BadInput(f"--set {name}: {path} does not ask for an argument of this name; "
                           + (nearest_of(name, given.names) if given.names else "leave it out"))
    return text


def check_is_robot(path: Path, expanded_root: Element | None) -> None:
    """BadInput for a file that only defines macros for other files, which is no robot by itself; `expanded_root`: None
    where xacro could not expand it."""
    source = xml_root(path, "is no XML")
    macros = [each.get("name", "") for each in source.iter(MACRO)]
    calls = [each.tag for each in source if each.tag.startswith("xacro:")
             and each.tag.removeprefix("xacro:") not in ("macro", "property", "arg", "include")]
    is_empty = not calls if expanded_root is None else expanded_root.find("link") is None
    if is_empty and macros and source.find("link") is None:
        names = ", ".join(macros[:4])
        raise BadInput(f"{path}: only defines the macro{'s' if macros[1:] else ''} {names}; import a file that calls "
                       f"{'them' if macros[1:] else 'it'}, such as one with <xacro:{macros[0]} …/>")


PATTERNS = (  # of what xacro says, and what we say
    (r"unknown macro name: (?:xacro:)?(.*)", "no macro {0} is defined; include the file that defines it"),
    (r"Undefined parameters \[(.*)\]", "a call of a macro lacks {0}; give it"),
    (r'Invalid parameter "(.*)"', "a call of a macro gives {0}, which the macro does not take; take it out"),
    (r'Unused block "(.*)"', "a call of a macro has a <{0}> that the macro does not take; take it out"),
    (r"Not enough blocks", "a call of a macro lacks a block; give it"),
    (r'Undefined block "(.*)"', "the block {0} is not defined"),
    (r"Undefined property to forward: (.*)", "the property {0} is not defined"),
    (r"circular variable definition: (.*)", "properties are defined by each other: {0}"),
    (r'Xacro conditional "(.*)" evaluated to .*', "the condition {0} is neither true nor false"),
    (r"macro names must not contain '\.' .*: (.*)", "{0} is no name for a macro"),
    (r"Property names must be valid python identifiers: (.*)", "{0} is no name for a property"),
    (r"(\S+): missing attribute '(.*)'", "<{0}> lacks the attribute {1}"),
    (r"Unknown substitution command \[(.*)\].*", "$({0}) is not known"))


def _words(causes: Sequence[BaseException]) -> str:
    """What is wrong in the file, in our words: those of an exception speak of Python."""
    for cause in reversed(causes):  # the innermost tells most
        if isinstance(cause, _Told):
            return str(cause)
        if isinstance(cause, ExpatError):
            return f"line {cause.lineno}, column {cause.offset + 1}: no well-formed XML"
        if isinstance(cause, OSError):
            return f"{cause.filename}: {reason_of(cause)}"
        if isinstance(cause, UnicodeDecodeError):
            return "a file is no text in UTF-8; save it as UTF-8"
        if type(cause).__name__ == "ArgException":
            return f"$(arg {_first(cause)}) has no value; give --set {_first(cause)}:=VALUE"
        for pattern, words in PATTERNS:
            if found := re.fullmatch(pattern, _first(cause), re.DOTALL):
                return words.format(*(" ".join(group.split())[:WORDS_AT_MOST] for group in found.groups()))
    return _words_of_expression(causes)


def _words_of_expression(causes: Sequence[BaseException]) -> str:
    """The expression that cannot be evaluated, and why."""
    texts = [re.search(r"when evaluating expression '(.*)'", str(getattr(each, "suffix", "") or ""), re.DOTALL)
             for each in causes]
    expression = next((" ".join(each[1].split())[:WORDS_AT_MOST] for each in reversed(texts) if each), "")
    where = f"the expression ${{{expression}}}" if expression else "an expression"
    for cause in reversed(causes):
        if isinstance(cause, NameError) and cause.name:
            return f"{where} uses {cause.name}, which is not defined{_old_definition(cause.name)}"
        if isinstance(cause, ZeroDivisionError):
            return f"{where} divides by 0"
        if isinstance(cause, SyntaxError):
            return f"{where} is not written as one"
    return f"{where} cannot be evaluated" if expression else "a part of it is not as xacro expects"


def _old_definition(name: str) -> str:
    """A file that was read and defines a property as the first versions of xacro did."""
    import xacro

    for file in dict.fromkeys(each for each in (*(xacro.all_includes or ()), *(xacro.filestack or ())) if each):
        with suppress(OSError, UnicodeDecodeError, ValueError):
            if re.search(rf'<property\s[^>]*name="{re.escape(name)}"', Path(file).read_text(encoding="utf-8")):
                return f" as {file} writes <property> for <xacro:property>"
    return ""


def _first(error: BaseException) -> str:
    """The words that the exception itself was given."""
    return str(error.args[0]) if error.args else ""


def _place(path: Path, causes: Sequence[BaseException]) -> str:
    """The macro and the file, where they are known and not the file that was given."""
    import xacro

    macros = [macro.body.getAttribute("name") for each in causes for macro in getattr(each, "macros", ())]
    file = next((each for each in reversed(xacro.filestack or []) if each), None)
    where = f" in macro {macros[0]}" if macros else ""
    return where + (f" in {file}" if file and Path(file).resolve() != path.resolve() else "")


class _Told(Exception):
    """An exception with our own words."""


class _Asked(dict[str, str]):
    """Arguments that note which `names` were asked for, by <xacro:arg> or $(arg …)."""

    def __init__(self, given: Mapping[str, str]):
        super().__init__(given)
        self.names: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.names.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.names.add(name)
        return super().__getitem__(name)


def _causes(error: BaseException) -> list[Any]:
    """The error and those that xacro has wrapped."""
    causes: list[Any] = [error]
    for each in causes:  # which grows meanwhile
        inner = getattr(each, "exc", None) or each.__cause__ or each.__context__
        if inner is not None and inner not in causes:
            causes.append(inner)
    return causes


def _keep_texts_of_yaml() -> None:
    """`load_yaml` takes the path of any file, whose text no message may show: it is to have keys, or to be a list."""
    import yaml

    load = yaml.safe_load

    def safe_load(stream: Any) -> Any:
        try:
            found = load(stream)
        except (yaml.YAMLError, UnicodeDecodeError):
            raise _Told(f"load_yaml: {stream.name} is no YAML") from None
        if not isinstance(found, (dict, list)):
            raise _Told(f"load_yaml: {stream.name} has no keys and is no list")
        return found

    yaml.safe_load = safe_load


def _answer_for_ros(files: MeshFiles) -> None:
    """xacro asks ROS (`ament_index_python`) where a package is; without ROS it asks `files`."""
    name = "ament_index_python.packages"
    module = types.ModuleType(name)
    module.get_package_share_directory = files.package_for_xacro  # type: ignore[attr-defined]
    sys.modules.update({name: module, "ament_index_python": types.ModuleType("ament_index_python")})
