"""The licences inside FMUs: of everything that others wrote and that is compiled in, from what is installed."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from fmu_importer import generic

from laconic.base.paths import SOURCE_DIR, built
from laconic.fmu import make_fmu
from laconic.scene import read_scene
from laconic_fmu.licences import COMPILER_TEXTS, FOLDER, licence_of, licence_parts

HEADER = built("parts") / "fmi/fmi3FunctionTypes.h"


def licences_in(fmu: Path) -> dict[str, str]:
    with zipfile.ZipFile(fmu) as archive:
        return {name.removeprefix(FOLDER): archive.read(name).decode("utf-8")
                for name in archive.namelist() if name.startswith(FOLDER)}


def test_an_fmu_has_the_licence_of_the_fmi_headers_beside_ours_with_and_without_sources(tmp_path):
    small = make_fmu(read_scene("robotino2"), tmp_path / "x.fmu", version=3, sources=False)
    for fmu in (generic(2), generic(3), small):
        texts = licences_in(fmu)
        assert set(texts) == {"license.txt", "fmi-headers.txt"}
        assert texts["license.txt"].startswith((SOURCE_DIR / "LICENSE").read_text(encoding="utf-8"))
        assert "fmi-headers.txt" in texts["license.txt"]
        assert "Redistributions in binary form must reproduce" in texts["fmi-headers.txt"]


def test_the_nodes_fmu_has_the_licence_of_its_generated_code_too():
    texts = licences_in(built("fmu") / "LaconicNode_fmi3.fmu")
    assert set(texts) == {"license.txt", "fmi-headers.txt", "cantools.txt"}
    assert "Erik Moqvist" in texts["cantools.txt"]


@pytest.mark.parametrize(("platforms", "parts"), [
    (["x86_64-linux", "aarch64-linux"], {"zig", "glibc"}), (["x86_64-windows"], {"zig", "mingw-w64", "musl"}),
    (["aarch64-darwin"], {"zig"})])
def test_binaries_of_the_compiler_for_other_platforms_bring_the_licences_of_what_it_adds(tmp_path, platforms, parts):
    for key, name in COMPILER_TEXTS.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f"licence of {key}", encoding="utf-8")
    made = licence_parts(b"ours\n", HEADER, {}, platforms, tmp_path)
    assert set(made) == {f"{FOLDER}{key}.txt" for key in {"license", "fmi-headers", *parts}}
    assert all(made[f"{FOLDER}{key}.txt"] == f"licence of {key}".encode() for key in parts)


def test_a_source_that_begins_without_its_licence_is_refused_by_its_path(tmp_path):
    (tmp_path / "bare.h").write_text("/* What it is for. */\n", encoding="utf-8")
    with pytest.raises(SystemExit, match=r"bare\.h: begins without its licence"):
        licence_of(tmp_path / "bare.h")
