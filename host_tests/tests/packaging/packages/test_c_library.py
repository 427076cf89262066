"""The core as a library of C: installed and found, or built inside of another project, whatever its options."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR, build_dir, built

needs_c_library = pytest.mark.skipif(shutil.which("cmake") is None or shutil.which("gcc") is None,
                                     reason="no cmake or gcc")


PROGRAM = """
#include <laconic/laconic.h>
#include <stdio.h>

int main(void) {
    puts(laconic_arithmetic_text(laconic_self_test()));
    return laconic_self_test() != LACONIC_ARITHMETIC_SOUND || sizeof(laconic_real) != SIZE;
}
"""
FOUND = """
cmake_minimum_required(VERSION 3.18)
project(user LANGUAGES C)
find_package(laconic 0.1 REQUIRED COMPONENTS {component})
add_executable(user user.c)
target_link_libraries(user PRIVATE laconic::{component})
"""
INSIDE = """
cmake_minimum_required(VERSION 3.18)
project(user LANGUAGES CXX)
get_cmake_property(before CACHE_VARIABLES)
set(flags_before "${{CMAKE_CXX_FLAGS}} ${{CMAKE_C_FLAGS}} ${{CMAKE_BUILD_TYPE}}")
{taken}
get_cmake_property(after CACHE_VARIABLES)
list(REMOVE_ITEM after ${{before}})
list(FILTER after EXCLUDE REGEX "^(CMAKE_|_CMAKE|FETCHCONTENT_|LACONIC_|laconic|_?core)")
get_property(tests DIRECTORY . PROPERTY TESTS)
if(after OR tests OR NOT flags_before STREQUAL "${{CMAKE_CXX_FLAGS}} ${{CMAKE_C_FLAGS}} ${{CMAKE_BUILD_TYPE}}")
    message(FATAL_ERROR "changed: ${{after}} ${{tests}} ${{CMAKE_C_FLAGS}}")
endif()
add_executable(user user.cpp)
target_link_libraries(user PRIVATE laconic::{component})
"""
SIZES = {"core": 8, "core_single": 4}


def run(*command: str | Path, **environment: str) -> str:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def refused(*command: str | Path) -> str:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    return " ".join(done.stderr.split())


def user(folder: Path, lists: str, component: str, ending: str = "c") -> Path:
    folder.mkdir(parents=True)
    (folder / "CMakeLists.txt").write_text(lists, encoding="utf-8")
    (folder / f"user.{ending}").write_text(PROGRAM.replace("SIZE", str(SIZES[component])), encoding="utf-8")
    return folder


def built_user(source: Path, *options: str) -> Path:
    run("cmake", "-S", source, "-B", source / "build", *options)
    run("cmake", "--build", source / "build", "-j2", "--target", "user")
    return source / "build" / "user"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where this build tree was installed to, and then moved: a folder with a space in its name."""
    folder = tmp_path_factory.mktemp("installed")
    run("cmake", "--install", build_dir(), "--prefix", folder / "first")
    return (folder / "first").rename(folder / "moved here")


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The core alone as a shared library of floats, installed through DESTDIR; its build finds no Python."""
    folder = tmp_path_factory.mktemp("shared")
    tools = folder / "tools"
    tools.mkdir()
    for name in ("cmake", "make", "ninja", "gcc", "cc", "as", "ld", "ar", "ranlib", "ccache"):
        if found := shutil.which(name):
            (tools / name).symlink_to(Path(found).resolve() if name == "cmake" else found)
    compiler = f"-DCMAKE_C_COMPILER={shutil.which('gcc')}"
    run("cmake", "-S", SOURCE_DIR / "core_c", "-B", folder / "build", "-DCMAKE_BUILD_TYPE=Debug", compiler,
        "-DBUILD_SHARED_LIBS=ON", "-DLACONIC_REALS=single", "-DCMAKE_INSTALL_PREFIX=/opt/laconic", PATH=str(tools))
    run("cmake", "--build", folder / "build", "-j2", PATH=str(tools))
    run("cmake", "--install", folder / "build", DESTDIR=str(folder / "stage"), PATH=str(tools))
    return folder / "stage" / "opt" / "laconic"


@needs_c_library
@pytest.mark.parametrize("component", SIZES)
def test_a_project_finds_the_installed_core_by_find_package(component, whole, tmp_path):
    source = user(tmp_path / "user", FOUND.format(component=component), component)
    assert run(built_user(source, f"-DCMAKE_PREFIX_PATH={whole}")) == "sound\n"


@needs_c_library
@pytest.mark.skipif(shutil.which("pkg-config") is None, reason="no pkg-config")
@pytest.mark.parametrize(("package", "component"), [("laconic", "core"), ("laconic_single", "core_single")])
def test_pkg_config_finds_it_where_it_was_moved_to(package, component, whole, tmp_path):
    source = user(tmp_path / "user", "", component)
    command = f'eval "cc user.c $(pkg-config --cflags --libs {package}) -o user"'
    libraries = next(whole.glob("lib*/**/pkgconfig"))
    subprocess.run(["sh", "-c", command], cwd=source, check=True,
                   env={**os.environ, "PKG_CONFIG_PATH": str(libraries)})
    assert run(source / "user") == "sound\n"
    assert run("pkg-config", "--modversion", package, PKG_CONFIG_PATH=str(libraries)).strip() == version()


def version() -> str:
    header = (SOURCE_DIR / "core_c/include/laconic/laconic.h").read_text(encoding="utf-8")
    return re.findall(r'^#define LACONIC_VERSION "(.*)"$', header, re.MULTILINE)[0]


@needs_c_library
def test_headers_licence_and_the_two_files_are_installed_and_each_component_by_itself(whole, tmp_path):
    there = {str(path.relative_to(whole)) for path in whole.rglob("*") if path.is_file()}
    headers = {f"include/laconic/{path.name}" for path in (SOURCE_DIR / "core_c/include/laconic").glob("*.h")}
    assert there >= headers | {"share/doc/laconic/LICENSE", "share/laconic/amalgamation/laconic.c"}
    assert there >= {f"share/laconic/soft_double/{name}.c" for name in ("soft_double", "check_double")}
    run("cmake", "--install", build_dir(), "--prefix", tmp_path, "--component", "laconic_amalgamation")
    assert {path.name for path in tmp_path.rglob("*") if path.is_file()} == {
        "laconic.h", "laconic.c", "laconic_single.h", "laconic_single.c"}


@needs_c_library
@pytest.mark.nightly
def test_the_core_alone_needs_no_python_and_makes_a_shared_library(shared, tmp_path):
    source = user(tmp_path / "user", FOUND.format(component="core_single"), "core_single")
    assert run(built_user(source, f"-DCMAKE_PREFIX_PATH={shared}")) == "sound\n"
    assert [*shared.rglob("liblaconic_single.*.so")] + [*shared.rglob("liblaconic_single.so.*")]


@pytest.mark.nightly
@needs_c_library
def test_a_component_that_was_not_built_is_missing_by_its_name(shared, tmp_path):
    source = user(tmp_path / "user", FOUND.format(component="core"), "core")
    message = refused("cmake", "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={shared}")
    assert "this installation has no core;" in message


@needs_c_library
def test_a_program_that_would_link_both_scalar_types_is_refused(whole, tmp_path):
    both = FOUND.format(component="core").replace("laconic::core)", "laconic::core laconic::core_single)")
    source = user(tmp_path / "user", both, "core")
    message = refused("cmake", "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={whole}")
    assert "LACONIC_REAL" in message


FETCHED = """
include(FetchContent)
FetchContent_Declare(laconic SOURCE_DIR "{folder}")
FetchContent_MakeAvailable(laconic)
"""


@needs_c_library
@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("g++") is None, reason="no g++")
@pytest.mark.parametrize(("taken", "component", "flags"), [
    (FETCHED.format(folder=SOURCE_DIR), "core", "-std=gnu11 -O1 -ffast-math -march=native"),
    (f'add_subdirectory("{SOURCE_DIR / "core_c"}" laconic)', "core_single", "-std=gnu11 -O0")])
def test_a_project_of_cpp_takes_it_in_and_neither_changes_the_other(taken, component, flags, tmp_path):
    source = user(tmp_path / "user", INSIDE.format(taken=taken, component=component), component, "cpp")
    real = "double" if component == "core" else "single"
    program = built_user(source, f"-DCMAKE_C_FLAGS={flags}", f"-DLACONIC_REALS={real}",
                         "-DFETCHCONTENT_FULLY_DISCONNECTED=ON")
    assert run(program) == "sound\n"


# ---- The page about C: its C++ program prints what the README's does, and its commands name what is there.

PAGE = (SOURCE_DIR / "docs" / "c.md").read_text(encoding="utf-8")
README = (SOURCE_DIR / "README.md").read_text(encoding="utf-8")


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("g++") is None, reason="no g++")
def test_its_program_in_cpp_prints_what_the_readme_states(tmp_path):
    (tmp_path / "program.cpp").write_text(re.findall(r"```cpp\n(.*?)```", PAGE, re.DOTALL)[0], encoding="utf-8")
    shutil.copytree(built("amalgamation"), tmp_path / "laconic")
    subprocess.run(["g++", "-std=c++11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I.", "-x", "c++", "program.cpp",
                    "laconic/laconic.c", "-o", "program"], cwd=tmp_path, check=True)
    printed = subprocess.run(["./program"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert printed == re.findall(r"```text\n(.*?)```", README, re.DOTALL)[0]


OF_PLANT = 5  # rows of the page that a plant needs; those behind them are of hinges
LOOP = """#include <laconic/laconic.h>
extern float battery_V, duty_left, duty_right;
void stop(void);
int start(const laconic_vehicle *robot);
void every_millisecond(void);
"""


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc")
def test_its_firmware_loop_compiles_and_a_plant_has_the_bytes_that_it_states(tmp_path):
    def compiled(name: str, text: str, *options: str) -> None:
        (tmp_path / name).write_text(text, encoding="utf-8")
        run("gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", *options,
            f"-I{SOURCE_DIR / 'core_c/include'}", tmp_path / name)

    section = PAGE.split("## In a firmware loop")[1]
    compiled("loop.c", LOOP + re.findall(r"```c\n(.*?)```", section, re.DOTALL)[0], "-DLACONIC_SINGLE")
    options: list[str] = []
    rows = re.findall(r"^\| ([^|]*) \| ([\d,]+) \|$", section.split("\n## ")[0], re.MULTILINE)
    hinged = " + ".join(f"sizeof(laconic_articulated_{part})" for part in ("model", "integrator", "state", "input"))
    for at, (build, size) in enumerate(rows):
        held = "sizeof(laconic_plant)" if at < OF_PLANT else hinged
        options = [*(options if "…" in build else ["-DLACONIC_SINGLE"] if "float" in build else []),
                   *re.findall(r"`(-D\S+)`", build)]
        compiled("size.c", "#include <laconic/laconic.h>\n#include <laconic/articulated.h>\n"
                 f"typedef char size[{held} == {size.replace(',', '')} ? 1 : -1];\n", *options)
    assert len(rows) == OF_PLANT + 4


@pytest.mark.nightly
def test_its_command_makes_the_two_files_by_python_alone(tmp_path):
    command = re.search(r"^PYTHONPATH=.* python3 (.*) laconic$", PAGE, re.MULTILINE)
    assert command is not None
    subprocess.run(["sh", "-c", f"{command[0].removesuffix(' laconic')} {tmp_path}"], cwd=SOURCE_DIR, check=True)
    assert (tmp_path / "laconic.c").read_bytes() == built("amalgamation/laconic.c").read_bytes()


@pytest.mark.nightly
def test_its_targets_components_and_options_exist():
    core, packages = SOURCE_DIR / "core_c", SOURCE_DIR / "packaging" / "c"
    files = [core / "CMakeLists.txt", *(core / "cmake").iterdir(), packages / "CMakeLists.txt"]
    lists = "".join(path.read_text(encoding="utf-8") for path in files)
    assert [name for name in re.findall(r"`(laconic_(?:runtime|development|amalgamation|packages))`", PAGE)
            if name not in lists] == []
    assert [name for name in re.findall(r"--target (\w+)", PAGE) if f"add_custom_target({name} " not in lists] == []
    assert [name for name in re.findall(r"`(LACONIC_[A-Z]+)`", PAGE) if name not in lists] == []


# ---- Names of core and node against macros of platforms: a file that such macros stand before compiles as without
# them.

# Words that headers, compilers or frameworks define, by where they come from. Each becomes a syntax error here.
WORDS = {
    "Windows": """near far small hyper pascal cdecl fortran interface NEAR FAR IN OUT OPTIONAL CALLBACK WINAPI
        APIENTRY CONST VOID THIS THIS_ PURE STRICT ERROR DELETE TRUE FALSE TRANSPARENT OPAQUE ABSOLUTE
        RELATIVE NO_ERROR DIFFERENCE INFINITE IGNORE MAX_PATH UNALIGNED DUPLICATE ALTERNATE WINDING
        SYNCHRONIZE SEVERITY_ERROR FACILITY_NULL grp1 grp2 rad1 rad2 chx1 edt1 lst1 scr1 stc1 ico1 psh1 cmb1
        ctl1 frm1 rct1""",
    "math.h and complex.h": "DOMAIN SING OVERFLOW UNDERFLOW TLOSS PLOSS HUGE I complex imaginary",
    "gcc in its own mode": "unix linux i386 arm mips sun vax",
    "16-bit and embedded compilers": """huge sbit sfr sfr16 idata pdata xdata bdata interrupt using reentrant rom ram
        eeprom persistent bank0 bank1 bank2 bank3 cregister ioport onchip monitor saddr callt sreg task""",
    "Arduino": """HIGH LOW INPUT OUTPUT INPUT_PULLUP PI HALF_PI TWO_PI DEG_TO_RAD RAD_TO_DEG EULER SERIAL DISPLAY
        LSBFIRST MSBFIRST CHANGE FALLING RISING DEFAULT INTERNAL EXTERNAL B0 B1 B00 B01 B10 B11 A0 A1 A2 A3
        A4 A5 A6 A7 SS SCK MISO MOSI SDA SCL""",
    "chips": """D0 D1 D2 D3 LED TX RX PORT PIN SP SREG CAN CAN0 CAN1 CRC RTC DMA DMA1 ADC ADC1 DAC TIM1 TIM2 USART1
        UART0 UART1 SPI1 I2C1 GPIOA GPIOB PWR RCC FLASH EXTI NVIC SCB SysTick IWDG WWDG RNG HASH SET RESET
        ENABLE DISABLE BIT0 BIT1 BIT7 BIT31""",
    "glibc, termios, curses, X": """major minor makedev environ B50 B110 B9600 ECHO Bool Status True False None
        Success Always Above Below Convex Complex""",
    "Qt": "signals slots emit foreach forever",
}
CALLED = """min max abs round constrain radians degrees sq bit bitRead bitSet bitClear bitWrite lowByte highByte word F
    interrupts noInterrupts swap clamp check verify require likely unlikely isnan isinf isfinite signbit BIT BV _BV MIN
    MAX CLAMP ARRAY_SIZE STRINGIFY CONTAINER_OF ROUND_UP SET_BIT CLEAR_BIT READ_BIT READ_REG WRITE_REG MODIFY_REG
    POSITION_VAL TEXT OF RGB UNUSED KB MB GB move erase clear refresh timeout getch border box scroll cli sei sbi
    cbi""".split()
CORE, NODE = SOURCE_DIR / "core_c", SOURCE_DIR / "firmware_stub"
FOLDERS = [CORE / "include", *(path for path in (CORE / "src").iterdir() if path.is_dir())]
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
needs_macro_names = pytest.mark.skipif(not COMPILERS, reason="neither gcc nor clang")


@pytest.fixture(scope="module")
def macros(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A header that defines them all, behind those of the C library."""
    words = [word for group in WORDS.values() for word in group.split()]
    lines = [f"#include <{name}.h>" for name in ("float", "stdbool", "stddef", "stdint", "string")]
    lines += [f"#undef {word}\n#define {word} @macro_{word}@" for word in words]
    lines += [f"#undef {word}\n#define {word}(...) @macro_{word}@" for word in CALLED]
    path = tmp_path_factory.mktemp("macros") / "macros.h"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def compiled(macros: Path, folders: list[Path], files: list[Path], *options: str) -> None:
    assert files
    done = subprocess.run([COMPILERS[0], "-std=c99", "-fsyntax-only", "-w", *options, "-include", str(macros),
                           *(f"-I{folder}" for folder in folders), *map(str, files)],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]


@needs_macro_names
def test_the_two_files_compile_behind_every_platforms_macros(macros):
    compiled(macros, [built("amalgamation")], [built("amalgamation/laconic.c")])
    compiled(macros, [built("amalgamation")], [built("amalgamation/laconic_single.c")])


@needs_macro_names
@pytest.mark.parametrize("part", ["articulated", "articulated_friction", "batch", "derivatives", "estimate", "filter",
                                  "soft_double"])
def test_each_optional_part_of_the_core_does(part, macros):
    files = [path for path in sorted((CORE / "optional" / part).glob("*.c")) if path.name != "check_double.c"]
    optional = [CORE / "optional" / name for name in ("articulated", "derivatives")]
    compiled(macros, [*FOLDERS, *optional], files)


@needs_macro_names
def test_the_node_its_drives_and_the_gate_do(macros):
    folders = [*FOLDERS, NODE / "include", NODE / "node", NODE / "drives"]
    files = [path for part in ("node", "wire", "secure", "drives") for path in (NODE / part).glob("**/*.c")]
    compiled(macros, [*folders, built("firmware_stub/wire")], sorted(files), "-DLACONIC_NODE_WITH_ESTIMATE=1",
             "-DLACONIC_NODE_WITH_HINGES=1", "-DLACONIC_NODE_WITH_XCP=1")
