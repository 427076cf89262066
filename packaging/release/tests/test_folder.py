"""The folder of the release: whole, told of in its bill, and without a trace of the machine that made it."""

from __future__ import annotations

import base64
import csv
import hashlib
import io
import json
import os
import tarfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from release_folder import DIST, VERSION

from laconic.base.paths import build_dir
from laconic_build.c.facts import ROOT
from laconic_build.release import archives, bill
from laconic_build.release.tree import tree_of
from laconic_build.wheel.contents import FMUS, PLATFORMS
from laconic_fmu.licences import COMPILER_TEXTS

ARCHIVES = (".zip", ".whl", ".fmu", ".pack")
FMU_FOLDERS = {"2": {"linux64", "aarch64-linux", "win64", "darwin64", "aarch64-darwin"},
               "3": {"x86_64-linux", "aarch64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-darwin"}}


def inside(name: str, data: bytes) -> Iterator[tuple[str, bytes]]:
    """A file, and what is in it if it is an archive, to any depth."""
    yield name, data
    if name.endswith(ARCHIVES):
        with zipfile.ZipFile(io.BytesIO(data)) as opened:
            for each in opened.namelist():
                yield from inside(f"{name}: {each}", opened.read(each))
    elif name.endswith((".tar.gz", ".tgz")):
        with tarfile.open(fileobj=io.BytesIO(data)) as tape:
            for entry in tape:
                file = tape.extractfile(entry)
                yield from inside(f"{name}: {entry.name}", file.read() if file else b"")


def test_its_checksums_are_right_and_complete() -> None:
    assert archives.wrong_files(DIST) == []


def test_its_bill_is_valid_by_the_schema_and_names_every_file() -> None:
    text = (DIST / f"laconic-{VERSION}.cdx.json").read_text(encoding="utf-8")
    assert bill.faults_of(text) == ""
    assert bill.unnamed(json.loads(text), DIST) == []


def test_no_file_nor_what_is_inside_of_it_holds_a_path_of_the_machine_that_made_it() -> None:
    here = [str(path).encode() + b"/" for path in (ROOT, build_dir(), Path.home()) if path != Path("/")]
    files = (path for path in DIST.rglob("*") if path.is_file())
    found = [name for path in files for name, data in inside(path.name, path.read_bytes())
             if any(path in data for path in here)]
    assert found == []


@pytest.mark.parametrize("name", PLATFORMS)
def test_a_wheel_is_what_its_name_and_its_record_state(name: str) -> None:
    tag = PLATFORMS[name].tag
    with zipfile.ZipFile(DIST / f"laconic-{VERSION}-py3-none-{tag}.whl") as wheel:
        about = f"laconic-{VERSION}.dist-info"
        tags = [line[5:] for line in wheel.read(f"{about}/WHEEL").decode().splitlines() if line.startswith("Tag: ")]
        assert sorted(tags) == sorted(f"py3-none-{each}" for each in tag.split("."))
        rows = {row[0]: row[1:] for row in csv.reader(io.StringIO(wheel.read(f"{about}/RECORD").decode()))}
        assert rows.keys() == set(wheel.namelist())
        for each, (digest, size) in rows.items():
            if digest:
                whole = base64.urlsafe_b64encode(hashlib.sha256(wheel.read(each)).digest()).rstrip(b"=").decode()
                assert (digest, int(size)) == (f"sha256={whole}", wheel.getinfo(each).file_size), each


@pytest.mark.parametrize("name", PLATFORMS)
def test_a_wheel_holds_the_licence_of_each_part_inside_of_it(name: str) -> None:
    platform = PLATFORMS[name]
    with zipfile.ZipFile(DIST / f"laconic-{VERSION}-py3-none-{platform.tag}.whl") as wheel:
        found = {Path(each).name for each in wheel.namelist() if "/licenses/" in each}
    parts = ("fmi-headers", "cantools", *COMPILER_TEXTS)
    assert found == {"LICENSE", *(f"LICENSE-{part}.txt" for part in parts)}


@pytest.mark.parametrize("name", FMUS)
def test_an_fmu_holds_the_licence_of_each_part_inside_of_it(name: str) -> None:
    with zipfile.ZipFile(DIST / name) as fmu:
        found = {Path(each).stem for each in fmu.namelist() if each.startswith("documentation/licenses/")}
    assert found - {"cantools"} == {"license", "fmi-headers", *COMPILER_TEXTS}
    assert ("cantools" in found) == name.startswith("LaconicNode")


@pytest.mark.parametrize("name", FMUS)
def test_an_fmu_holds_a_binary_for_every_platform(name: str) -> None:
    with zipfile.ZipFile(DIST / name) as fmu:
        found = {each.split("/")[1] for each in fmu.namelist() if each.startswith("binaries/")}
    assert found == FMU_FOLDERS[name[-5]]


@pytest.mark.parametrize("name", FMUS)
def test_an_fmu_is_valid_for_fmpy_and_is_the_one_in_every_wheel(name: str) -> None:
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(DIST / name)) == []
    data = (DIST / name).read_bytes()
    for platform in PLATFORMS.values():
        with zipfile.ZipFile(DIST / f"laconic-{VERSION}-py3-none-{platform.tag}.whl") as wheel:
            assert wheel.read(f"laconic/_built/fmu/{name}") == data


def test_the_sources_are_those_of_the_commit() -> None:
    tree = tree_of(ROOT)
    with tarfile.open(DIST / f"laconic-source-{VERSION}.tar.gz") as tape:
        modes = {entry.name.partition("/")[2]: entry.mode for entry in tape}
    assert set(modes) == set(tree.files)
    assert {name for name, mode in modes.items() if mode & 0o111} == tree.programs
    assert os.access(ROOT / ".ci" / "run", os.X_OK) == (".ci/run" in tree.programs)
