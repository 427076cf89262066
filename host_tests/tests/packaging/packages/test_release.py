"""What makes the release: the same files are the same bytes, and nothing in it is without checksum and licence."""

from __future__ import annotations

import ast
import io
import json
import os
import shutil
import subprocess
import tarfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR
from laconic_build.c.embedded import TOOLS
from laconic_build.c.facts import Facts, facts, placeholders
from laconic_build.release import archives, bill
from laconic_build.release.archives import File
from laconic_build.release.collect import collect
from laconic_build.release.parts import Places
from laconic_build.release.products import FOR_DEVELOPERS, products
from laconic_build.release.tree import NoRelease, Tree, check_tools, tree_of
from laconic_build.wheel import cross
from laconic_build.wheel.contents import FMUS, PLATFORMS, python_files
from laconic_fmu.cross import TARGETS

DATE = 1_700_000_000
FILES = {"b/two": File(b"2\n"), "a": File(b"1" * 1000), "b/run": File(b"#!/bin/sh\n", is_program=True)}
MADE_SITE = ("furo", "sphinx", "pygments", "snowballstemmer", "sphinx-basic-ng", "myst-parser")

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="no git")


@pytest.mark.parametrize("packed", [archives.zip_of, archives.tar_gz_of])
def test_an_archive_depends_on_its_files_and_its_date_alone(packed) -> None:
    other_order = dict(reversed(FILES.items()))
    assert packed(FILES, DATE) == packed(other_order, DATE)
    assert packed(FILES, DATE) != packed(FILES, DATE + 86400)
    assert packed(FILES, DATE) != packed({**FILES, "a": File(b"0")}, DATE)


def test_archives_hold_what_was_given_and_programs_stay_programs() -> None:
    with zipfile.ZipFile(io.BytesIO(archives.zip_of(FILES, DATE))) as made:
        assert {each.filename: (made.read(each), each.external_attr >> 16 & 0o777) for each in made.infolist()} == {
            name: (file.data, file.mode) for name, file in FILES.items()}
        assert made.infolist()[0].date_time == (2023, 11, 14, 22, 13, 20)
    with tarfile.open(fileobj=io.BytesIO(archives.tar_gz_of(FILES, DATE))) as tape:
        assert [(each.name, each.mode, each.mtime, each.uname) for each in tape] == [
            (name, FILES[name].mode, DATE, "") for name in sorted(FILES)]


def test_checksums_tell_a_file_that_is_wrong_missing_or_not_named(tmp_path: Path) -> None:
    for name in ("a", "b", "c"):
        (tmp_path / name).write_text(name)
    archives.write(tmp_path)
    if shutil.which("sha256sum"):
        subprocess.run(["sha256sum", "--quiet", "-c", "SHA256SUMS"], cwd=tmp_path, check=True)
    assert archives.wrong_files(tmp_path) == []
    (tmp_path / "a").write_text("other")
    (tmp_path / "b").unlink()
    (tmp_path / "d").write_text("new")
    assert archives.wrong_files(tmp_path) == ["a", "b", "d"]


def test_facts_that_stand_for_others_are_named() -> None:
    told = {"contact": "us@laconic.example", "homepage": "https://laconic.example", "sentence": "For example."}
    assert placeholders(Facts(**{**vars(facts()), **told})) == ["contact", "homepage"]


@pytest.fixture
def tree(tmp_path: Path) -> Tree:
    """A checkout with those files of ours that texts are made of."""
    folder = tmp_path / "checkout"
    (folder / "core_c" / "include").mkdir(parents=True)
    shutil.copyfile(SOURCE_DIR / "README.md", folder / "README.md")
    (folder / "core_c" / "CMakeLists.txt").write_text("# core\n")
    (folder / "core_c" / "include" / "laconic.h").write_text("/* core */\n")
    date = f"@{DATE} +0000"
    us = {**os.environ, "GIT_AUTHOR_DATE": date, "GIT_COMMITTER_DATE": date, "GIT_CONFIG_GLOBAL": os.devnull}
    for words in (("init", "-q"), ("add", "-A"),
                  ("-c", "user.name=us", "-c", "user.email=us@laconic.example", "commit", "-qm", "first")):
        subprocess.run(["git", *words], cwd=folder, env=us, check=True)
    return tree_of(folder)


@pytest.fixture
def places(tmp_path: Path) -> Places:
    """Packages and files of others, as far as licences are read from them."""
    site, cross = tmp_path / "site", tmp_path / "cross"
    for folder, name in [*((site, each) for each in MADE_SITE), (cross, "ziglang")]:
        put(folder / f"{name}.dist-info" / "METADATA", f"Name: {name}\nVersion: 1.2.3\n")
        put(folder / f"{name}.dist-info" / "LICENSE", f"Copyright of {name}\n")
        put(folder / f"{name}.dist-info" / "RECORD", f"{name}.dist-info/LICENSE,,\n")
    put(site / "furo/theme/furo/static/scripts/furo.js.LICENSE.txt", "gumshoe\n")
    for name in ("LICENSE", "lib/libc/mingw/COPYING", "lib/libc/musl/COPYRIGHT", "lib/libc/glibc/LICENSES"):
        put(cross / "ziglang" / name, "Copyright of zig\n")
    put(tmp_path / "fmi3FunctionTypes.h", "/* Copyright of FMI */\n")
    put(tmp_path / "laconic_dbc.c", "/* Copyright of cantools */\n")
    return Places(tmp_path, tmp_path, cross / "ziglang", site)


def put(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


@pytest.fixture
def build(tmp_path: Path) -> Path:
    """A build tree in which everything was made, as stand-ins."""
    told, folder = facts(), tmp_path / "build"
    for platform in PLATFORMS.values():
        path = folder / "dist" / f"laconic-{told.version}-py3-none-{platform.tag}.whl"
        path.parent.mkdir(parents=True, exist_ok=True)
        needs = "Name: laconic\nRequires-Dist: numpy>=1\nRequires-Dist: scipy>=1; extra == 'analysis'\n"
        path.write_bytes(archives.zip_of({"laconic.dist-info/METADATA": File(needs.encode())}, DATE))
    for name in FMUS:
        put(folder / "fmu" / name, name)
    for tool in TOOLS.values():
        put(folder / "packages/embedded" / tool.archive.format(version=told.version, title=told.title), tool.folder)
    for name in ("amalgamation/laconic.h", "amalgamation/laconic.c", "page/laconic.html", "site/html/index.html",
                 "site/html/.buildinfo", f"npm/laconic-robots-{told.version}.tgz"):
        put(folder / name, name)
    return folder


@pytest.fixture
def released(tree: Tree, build: Path, places: Places, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A release; the schema is asked when a real one is made, by a library that is fetched for that alone."""
    monkeypatch.setattr(bill, "faults_of", lambda text: "")
    return collect(tree, facts(), build, tmp_path / "dist", places, {"clang": "clang 1"}).folder


def test_a_release_made_twice_has_the_same_bytes(released: Path, tree: Tree, build: Path, places: Places) -> None:
    first = {path.name: path.read_bytes() for path in released.rglob("*") if path.is_file()}
    made = collect(tree, facts(), build, released, places, {"clang": "clang 1"})
    assert {path.name: path.read_bytes() for path in released.rglob("*") if path.is_file()} == first
    assert (made.count, made.size) == (len(first), sum(map(len, first.values())))
    assert archives.wrong_files(released) == []


def test_every_file_of_a_release_is_in_its_bill_with_checksum_and_licence(released: Path) -> None:
    (path,) = released.glob("*.cdx.json")
    told = json.loads(path.read_text(encoding="utf-8"))
    entries = {each["bom-ref"]: each for each in told["components"]}
    assert bill.unnamed(told, released) == []
    for name, digest in archives.sums_of(released).items():
        if name != path.name:
            assert entries[name]["hashes"] == [{"alg": "SHA-256", "content": digest}]
            assert name.startswith("licences/") or entries[name]["licenses"] == [{"license": {"id": "MIT"}}]
    put(released / "stowaway", "")
    assert bill.unnamed(told, released) == ["stowaway"]


def test_every_part_that_others_wrote_is_in_the_bill_beside_its_licence(released: Path, tree: Tree,
                                                                         build: Path) -> None:
    told = json.loads(next(released.glob("*.cdx.json")).read_text(encoding="utf-8"))
    entries = {each["bom-ref"]: each for each in told["components"]}
    inside = {each["ref"]: each["dependsOn"] for each in told["dependencies"]}
    for product in products(tree, facts(), build):
        assert (released / product.name).exists()
        assert {f"part:{key}" for key in product.holds} <= set(inside[product.name])
        for key in product.holds:
            assert "copyright" in (released / "licences" / f"{key}.txt").read_text(encoding="utf-8").lower()
            assert entries[f"part:{key}"]["licenses"] and entries[f"part:{key}"]["version"]
    assert inside.keys() | {each for refs in inside.values() for each in refs} <= entries.keys() | {"laconic"}
    assert [(entries[f"pip:{name}"]["scope"]) for name in ("numpy", "scipy")] == ["required", "optional"]


def test_its_readme_names_every_file(released: Path) -> None:
    text = (released / "README.md").read_text(encoding="utf-8")
    there = {path.name for path in released.iterdir()}
    assert [name for name in there - {"README.md"} if f"* `{name}`: " not in text] == []


def test_a_folder_with_other_things_is_refused_and_kept(released: Path, tree: Tree, build: Path,
                                                        places: Places) -> None:
    put(released / "thesis.txt", "ten years of work")
    with pytest.raises(NoRelease, match=r"holds thesis\.txt, which is of no release; move it away, or name another"):
        collect(tree, facts(), build, released, places, {})
    assert (released / "thesis.txt").exists()


def test_what_was_not_built_is_named_and_the_former_release_stays(released: Path, tree: Tree, build: Path,
                                                                    places: Places) -> None:
    (build / "page" / "laconic.html").unlink()
    with pytest.raises(NoRelease, match=r"laconic\.html: .* was not built; build the target laconic_release"):
        collect(tree, facts(), build, released, places, {})
    assert archives.wrong_files(released) == []


def test_all_that_was_not_built_is_named_at_once(released: Path, tree: Tree, build: Path, places: Places) -> None:
    (build / "page" / "laconic.html").unlink()
    (build / "fmu" / FMUS[0]).unlink()
    with pytest.raises(NoRelease) as why:
        collect(tree, facts(), build, released, places, {})
    assert "laconic.html: " in str(why.value) and f"{FMUS[0]}: " in str(why.value)
    assert str(why.value).endswith(" were not built; build the target laconic_release")
    assert archives.wrong_files(released) == []


def test_all_tools_that_a_release_lacks_are_named_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    here = tmp_path / "bin"
    monkeypatch.setenv("PATH", str(here))
    with pytest.raises(NoRelease) as why:
        check_tools("clang", tmp_path)
    assert str(why.value).startswith("this machine lacks git, a clang with WebAssembly, its linker wasm-ld, the compi"
                                     "ler for other platforms (the build fetches ziglang); install what is missing")
    for name in ("git", "clang", "wasm-ld"):
        put(here / name, "")
        (here / name).chmod(0o755)
    with pytest.raises(NoRelease, match="lacks the compiler for other platforms .the build fetches ziglang.; install"):
        check_tools("clang", tmp_path)
    (tmp_path / "lib" / "python3.11" / "site-packages" / "ziglang").mkdir(parents=True)
    check_tools("clang", tmp_path)


@pytest.mark.skipif(shutil.which("cmake") is None, reason="no CMake")
@pytest.mark.parametrize("there, lacking", [
    ((), "git, clang, wasm-ld (in the package lld)"), (("git",), "clang, wasm-ld (in the package lld)"),
    (("clang",), "git, wasm-ld (in the package lld)"), (("git", "clang"), "wasm-ld (in the package lld)")])
def test_the_build_names_all_tools_that_a_release_lacks(tmp_path: Path, there: tuple[str, ...], lacking: str) -> None:
    tools = {"LACONIC_GIT": "git", "LACONIC_WASM_CLANG": "clang", "LACONIC_WASM_LD": "wasm-ld"}
    lines = [f'set({name} "{tool if tool in there else "NOTFOUND"}" CACHE FILEPATH "")' for name, tool in tools.items()]
    put(tmp_path / "CMakeLists.txt", "\n".join([
        "cmake_minimum_required(VERSION 3.25)", "project(release LANGUAGES NONE)", "set(LACONIC_FMU_ALL ON)",
        "set(CMAKE_PROGRAM_PATH nowhere)", "set(CMAKE_FIND_USE_SYSTEM_ENVIRONMENT_PATH OFF)",
        "set(CMAKE_FIND_USE_CMAKE_SYSTEM_PATH OFF)", *lines,
        f'add_subdirectory("{SOURCE_DIR / "packaging" / "release"}" release)']))
    folder = tmp_path / "build"
    told = subprocess.run(["cmake", "-S", str(tmp_path), "-B", str(folder)], capture_output=True, text=True,
                          check=True)
    assert f"no release: this machine lacks {lacking}\n" in told.stdout
    done = subprocess.run(["cmake", "--build", str(folder), "--target", "laconic_release"], capture_output=True,
                          text=True, check=False)
    assert done.returncode != 0 and f"this machine lacks {lacking}: install what is missing" in done.stdout


def test_changes_that_no_commit_holds_are_told(tree: Tree) -> None:
    assert (tree.changed, tree.epoch) == ((), DATE)
    put(tree.folder / "README.md", "other")
    put(tree.folder / "new", "")
    again = tree_of(tree.folder)
    assert again.changed == ("README.md", "new")
    assert "new" not in again.files


def test_a_folder_that_git_does_not_know_is_refused_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(NoRelease, match="is no checkout of git") as why:
        tree_of(tmp_path)
    assert "\n" not in str(why.value)


def test_the_fmus_in_a_wheel_run_on_the_systems_that_its_tag_names():
    """A glibc or a macOS without a version would be the newest that the compiler knows."""
    of_wheels = {each.target for each in PLATFORMS.values() if "musl" not in each.target}
    assert set(TARGETS.values()) == of_wheels


def test_the_node_of_a_wheel_for_another_platform_has_every_room_of_the_node(monkeypatch, tmp_path: Path) -> None:
    compiled: list[list[Path]] = []
    monkeypatch.setattr(cross, "compile_to", lambda target, sources, *rest, **more: compiled.append(list(sources)))
    cross.compile_all(PLATFORMS["linux-x86_64"], SOURCE_DIR, tmp_path, tmp_path, "python")
    process = {path.relative_to(SOURCE_DIR / "firmware_stub").parts[0] for path in compiled[-1]
               if SOURCE_DIR / "firmware_stub" in path.parents}
    rooms = {folder.name for folder in (SOURCE_DIR / "firmware_stub").iterdir() if any(folder.rglob("*.c"))}
    assert len(compiled) == 6 and process == rooms - {"tests"}


def test_the_core_of_a_wheel_for_another_platform_has_every_part_but_the_soft_addition(monkeypatch,
                                                                                        tmp_path: Path) -> None:
    compiled: list[set[Path]] = []
    monkeypatch.setattr(cross, "compile_to", lambda target, sources, *rest, **more: compiled.append(set(sources)))
    cross.compile_all(PLATFORMS["windows-x86_64"], SOURCE_DIR, tmp_path, tmp_path, "python")
    parts = [SOURCE_DIR / "core_c" / "src", *(SOURCE_DIR / "core_c" / "optional").iterdir()]
    every = {path for part in parts if part.name != "soft_double" for path in part.rglob("*.c")}
    assert len(compiled) == 4 and all(every <= sources for sources in compiled)


def test_what_the_core_for_users_leaves_out_is_there():
    """A name that moved would come back into the archive unseen."""
    kept = {path.name for path in (SOURCE_DIR / "core_c").iterdir()} - set(FOR_DEVELOPERS)
    assert all((SOURCE_DIR / "core_c" / name).exists() for name in FOR_DEVELOPERS)
    assert kept == {"CMakeLists.txt", "cmake", "include", "optional", "src"}


STARTED_BY_NAME = {"laconic.__main__", "laconic.fmu.bus_demo"}


def test_every_module_of_a_wheel_is_a_command_or_imported_by_another() -> None:
    """Else it serves the build or the tests alone, and nobody who installs the wheel."""
    files = {name.removesuffix(".py").removesuffix("/__init__").replace("/", "."): path
             for name, path in python_files(SOURCE_DIR).items() if name.endswith(".py")}
    imported = {name for module, path in files.items() for name in imports_of(module, path)}
    unused = {name for name, path in files.items() if name not in imported and path.name != "__init__.py"
              and not name.startswith("laconic.cli.commands.")}
    assert unused == STARTED_BY_NAME
    assert {name for name in imported if name.startswith("laconic_fmu.")} <= files.keys()


def imports_of(module: str, path: Path) -> Iterator[str]:
    """Modules, as far as they are ours; names that are no modules, too."""
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package.rsplit(".", node.level - 1)[0] if node.level else ""
            source = ".".join(part for part in (above, node.module or "") if part)
            yield from (source, *(f"{source}.{alias.name}" for alias in node.names if source in ("laconic", package)
                                  or source.startswith("laconic.")))
