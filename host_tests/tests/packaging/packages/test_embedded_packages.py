"""The packages of embedded tools: their metadata, the files that it names, and examples that compile for a Cortex-M4F.

The tools' own checks are not at hand in every environment; here stand the rules that their documents give.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

from laconic.base.paths import SOURCE_DIR, built
from laconic_build.c.embedded import TOOLS, package, values_of
from laconic_build.c.facts import facts

pytestmark = pytest.mark.nightly

FACTS = json.loads((SOURCE_DIR / "packaging" / "facts.json").read_text(encoding="utf-8"))
HEADER = (SOURCE_DIR / "core_c/include/laconic/laconic.h").read_text(encoding="utf-8")
VERSION = re.findall(r'^#define LACONIC_VERSION "(.*)"$', HEADER, re.MULTILINE)[0]
FOLDERS = {"arduino": "arduino/Laconic", "platformio": "platformio/Laconic", "esp-idf": "esp-idf/laconic",
           "zephyr": "zephyr/laconic", "cmsis-pack": "cmsis-pack"}
ARM = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-O1", "-Wall", "-Wextra", "-Werror"]
STUB_OF_ARDUINO = """
#include <math.h>
#include <stdint.h>
struct serial { void begin(long); void print(const char *); void print(float, int); void println(const char *);
                void println(float, int); };
extern serial Serial;
void delay(unsigned long);
"""


def folder(tool: str) -> Path:
    return built(f"packages/embedded/{FOLDERS[tool]}")


def headers(tool: str) -> Path:
    return folder(tool) / ("src" if tool == "arduino" else "include")


def text(tool: str, name: str) -> str:
    return (folder(tool) / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("tool", FOLDERS)
def test_a_package_holds_the_two_files_the_licence_and_no_gap_of_a_template(tool):
    files = [path for path in folder(tool).rglob("*") if path.is_file()]
    for name in ("laconic.h", "laconic.c", "laconic_single.h", "laconic_single.c"):
        where = headers(tool) if name.endswith(".h") else folder(tool) / "src"
        assert (where / name).read_bytes() == built(f"amalgamation/{name}").read_bytes()
    assert (folder(tool) / "LICENSE").read_bytes() == (SOURCE_DIR / "LICENSE").read_bytes()
    others = [path.read_text(encoding="utf-8") for path in files if not path.name.startswith("laconic")]
    assert [found for each in others for found in re.findall(r"@[a-z_]+@", each)] == []


@pytest.mark.parametrize("tool", FOLDERS)
def test_the_readmes_example_compiles_by_its_own_include_and_by_the_packages(tool, tmp_path):
    example = re.findall(r"```c\n(.*?)```", (SOURCE_DIR / "README.md").read_text("utf-8"), re.DOTALL)[0]
    assert example.startswith("#include <laconic/laconic.h>")
    both = "#include <laconic/laconic_single.h>\n#include <laconic_single.h>\n#include <laconic.h>\n"
    (tmp_path / "program.c").write_text(both + example, encoding="utf-8")
    sources = [folder(tool) / "src" / name for name in ("laconic.c", "laconic_single.c")]
    subprocess.run(["cc", "-O0", "-Wall", "-Wextra", "-Werror", f"-I{headers(tool)}", tmp_path / "program.c", *sources,
                    "-o", tmp_path / "program"], check=True)
    done = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("after 2 s at x = 0.230 m")


@pytest.mark.parametrize("tool", FOLDERS)
def test_its_archive_holds_the_same_files(tool):
    inside = f"{FOLDERS[tool].partition('/')[2]}/".lstrip("/")
    wanted = {f"{inside}{path.relative_to(folder(tool)).as_posix()}": path.read_bytes()
              for path in folder(tool).rglob("*") if path.is_file()}
    names = [path for path in built("packages/embedded").iterdir() if path.suffix in (".zip", ".pack")]
    contents = [{name: packed.read(name) for name in packed.namelist()} for packed in map(zipfile.ZipFile, names)]
    assert wanted in contents
    assert all(VERSION in path.name for path in names)


DEMANDED = {"arduino": "url=", "cmsis-pack": "<url>"}  # by the tool, whatever the address


@pytest.mark.parametrize("tool", TOOLS)
def test_an_address_that_is_a_placeholder_is_shown_only_where_the_tool_demands_one(tool):
    pages, mails = {"homepage": "https://laconic.example"}, {"contact": "us@laconic.example"}
    real = {"homepage": "https://robots.test/laconic", "contact": "us@robots.test"}
    lines = [line.strip() for line in lines_with(tool, {**pages, **mails}) if ".example" in line]
    assert all(line.startswith(DEMANDED.get(tool, "nothing")) for line in lines)
    shown = "\n".join(lines_with(tool, real))
    has_manifest = tool != "zephyr"
    assert all((address in shown) == has_manifest for address in real.values()), shown


def lines_with(tool, told):
    """The lines of a package whose facts are these."""
    ours = replace(facts(), **told)
    return "\n".join(package(tool, {}, values_of(ours), ours).values()).splitlines()


def test_arduino_has_every_field_that_its_specification_asks_for():
    given = dict(line.split("=", 1) for line in text("arduino", "library.properties").splitlines())
    assert given.keys() == {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url",
                            "architectures", "includes"}
    assert re.fullmatch(r"[A-Za-z0-9][\w .-]*", given["name"])
    assert given["version"] == VERSION
    assert given["sentence"] == FACTS["sentence"]
    assert given["category"] in ("Communication", "Data Processing", "Data Storage", "Device Control", "Display",
                                 "Other", "Sensors", "Signal Input/Output", "Timing")
    assert given["url"].startswith("https://")
    assert "avr" not in given["architectures"].split(",")
    assert (folder("arduino") / "src" / given["includes"]).exists()
    assert [path.stem for path in folder("arduino").rglob("*.ino")] == ["Curve"]  # as its folder


def test_platformio_has_its_fields_and_names_files_that_are_there():
    given = json.loads(text("platformio", "library.json"))
    assert (given["version"], given["license"], given["description"]) == (VERSION, "MIT", FACTS["sentence"])
    assert len(given["description"]) <= 255
    assert given["authors"][0]["name"] == FACTS["author"]
    assert all(re.fullmatch(r"[a-z\d-]+", word) for word in given["keywords"])
    for example in given["examples"]:
        assert all((folder("platformio") / example["base"] / name).exists() for name in example["files"])
    assert all((folder("platformio") / "include" / name).exists() for name in given["headers"])


STUBBED = """
cmake_minimum_required(VERSION 3.16)
function(idf_component_register)
    cmake_parse_arguments(given "" "" "SRCS;INCLUDE_DIRS;REQUIRES" ${ARGN})
    foreach(path ${given_SRCS} ${given_INCLUDE_DIRS})
        message("there: ${CMAKE_CURRENT_LIST_DIR}/${path}")
    endforeach()
endfunction()
function(zephyr_include_directories path)
    message("there: ${CMAKE_CURRENT_LIST_DIR}/${path}")
endfunction()
function(zephyr_library_named name)
endfunction()
function(zephyr_library_sources_ifdef flag path)
    if(${flag})
        message("there: ${CMAKE_CURRENT_LIST_DIR}/${path}")
    endif()
endfunction()
"""


@pytest.mark.skipif(shutil.which("cmake") is None, reason="no cmake")
@pytest.mark.parametrize(("tool", "lists", "count"), [
    ("esp-idf", "CMakeLists.txt", 3), ("esp-idf", "examples/curve/main/CMakeLists.txt", 1),
    ("zephyr", "zephyr/CMakeLists.txt", 2)])
def test_its_build_file_names_files_that_are_there(tool, lists, count, tmp_path):
    """The tools' functions are stubs that print the paths that they are given."""
    script = tmp_path / "script.cmake"
    script.write_text(f'{STUBBED}set(CONFIG_LACONIC ON)\nset(CONFIG_LACONIC_SINGLE ON)\n'
                      f'include("{folder(tool) / lists}")\n', encoding="utf-8")
    done = subprocess.run(["cmake", "-P", str(script)], capture_output=True, text=True, check=True)
    named = re.findall(r"^there: (.*)$", done.stderr, re.MULTILINE)
    assert len(named) == count
    assert [path for path in named if not Path(path).exists()] == []


def test_esp_idf_and_zephyr_state_version_and_folders():
    assert f'version: "{VERSION}"' in text("esp-idf", "idf_component.yml")
    assert (folder("esp-idf") / re.findall(r"path: (\S+)", text("esp-idf", "idf_component.yml"))[0]).is_dir()
    module = text("zephyr", "zephyr/module.yml")
    assert (folder("zephyr") / re.findall(r"kconfig: (\S+)", module)[0]).exists()
    assert (folder("zephyr") / re.findall(r"cmake: (\S+)", module)[0] / "CMakeLists.txt").exists()


def test_the_cmsis_pack_describes_the_files_that_it_has():
    root = ElementTree.fromstring(text("cmsis-pack", "Laconic.Laconic.pdsc"))
    order = ["vendor", "name", "description", "url", "license", "licenseSets", "releases", "keywords",
             "taxonomy", "components"]
    assert [child.tag for child in root] == order
    release = root.find("releases/release")
    assert release is not None and release.get("version") == VERSION
    files = [file.get("name", "") for file in root.iter("file")]
    assert [name for name in files if not (folder("cmsis-pack") / name).exists()] == []
    assert {component.get("Cversion") for component in root.iter("component")} == {VERSION}


EXAMPLES = {"arduino": "examples/Curve/Curve.ino", "platformio": "examples/curve/main.c",
            "esp-idf": "examples/curve/main/main.c", "zephyr": "samples/curve/src/main.c",
            "cmsis-pack": "examples/curve.c"}


@pytest.fixture(scope="module")
def compiled_core(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """laconic_single.o for a Cortex-M4F, as a framework with -std=gnu17 compiles it; all packages hold the same."""
    out = tmp_path_factory.mktemp("core") / "laconic_single.o"
    subprocess.run(["arm-none-eabi-gcc", "-std=gnu17", *ARM, "-ffunction-sections", "-fdata-sections", "-c",
                    str(built("amalgamation/laconic_single.c")), "-o", str(out)], check=True)
    return out


@pytest.mark.skipif(shutil.which("arm-none-eabi-g++") is None, reason="no arm-none-eabi-g++")
@pytest.mark.parametrize("tool", EXAMPLES)
def test_its_example_compiles_for_a_cortex_m4f_and_links_or_names_only_what_the_framework_has(
        tool, compiled_core, tmp_path):
    (tmp_path / "Arduino.h").write_text(STUB_OF_ARDUINO, encoding="utf-8")
    source, include = folder(tool) / EXAMPLES[tool], headers(tool)
    how = ["arm-none-eabi-g++", "-std=gnu++17", "-x", "c++", "-include", str(tmp_path / "Arduino.h")] \
        if tool == "arduino" else ["arm-none-eabi-gcc", "-std=gnu17"]
    subprocess.run([*how, *ARM, f"-I{include}", "-c", str(source), "-o", str(tmp_path / "main.o")], check=True)
    subprocess.run(["arm-none-eabi-ld", "-r", str(tmp_path / "main.o"), str(compiled_core), "-o",
                    str(tmp_path / "all.o")], check=True)
    names = subprocess.run(["arm-none-eabi-nm", "-u", str(tmp_path / "all.o")], capture_output=True, text=True,
                           check=True).stdout.split()[1::2]
    assert [name for name in names if "laconic" in name] == []


@pytest.mark.skipif(shutil.which("arm-none-eabi-objdump") is None, reason="no arm-none-eabi-objdump")
def test_without_any_option_for_bits_a_cortex_m4f_fuses_nothing(compiled_core):
    listing = subprocess.run(["arm-none-eabi-objdump", "-d", str(compiled_core)], capture_output=True, text=True,
                             check=True).stdout
    assert "vmul.f32" in listing
    assert re.findall(r"\bvfn?m[as]\.f32", listing) == []
