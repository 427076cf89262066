"""laconic_self_test() finds what options and modes do to arithmetic; what compilers admit does not compile."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CORE = Path(__file__).parents[4] / "core_c"
SOURCES = [CORE / "src/common/self_test.c", CORE / "tests/common/self_test_under.c"]
FOLDERS = [f"-I{path}" for path in sorted((CORE / "src").iterdir())]
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
needs_self_test = pytest.mark.skipif(not COMPILERS, reason="neither gcc nor clang")
SOUND = ["-std=c99", "-O2", "-ffp-contract=off", "-fno-tree-slp-vectorize"]
SILENCED = {  # as a compiler that defines no macro: the options of the refusals below
    "finite": ["-ffinite-math-only", "-U__FINITE_MATH_ONLY__", "-D__FINITE_MATH_ONLY__=0"],
    "associative": ["-funsafe-math-optimizations", "-U__ASSOCIATIVE_MATH__", "-U__RECIPROCAL_MATH__"],
    "reciprocal": ["-freciprocal-math", "-U__RECIPROCAL_MATH__"],
}
X87 = ["-mfpmath=387", "-U__FLT_EVAL_METHOD__", "-D__FLT_EVAL_METHOD__=0"]


def processor_has(flag: str) -> bool:
    """Whether this processor is an x86 with a feature."""
    info = Path("/proc/cpuinfo")
    return info.exists() and flag in info.read_text().split()


def compiled(compiler: str, options: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """The messages of the compiler about the self-test with its driver."""
    return subprocess.run([compiler, "-w", "-I", str(CORE / "include"), *FOLDERS, *options, *map(str, SOURCES), "-lm",
                           "-o", str(folder / "self_test")], capture_output=True, text=True, check=False)


def found(compiler: str, options: list[str], folder: Path, mode: str = "nearest") -> str:
    """What the self-test finds when it is compiled so and run in that mode."""
    made = compiled(compiler, options, folder)
    if "not supported" in made.stderr or "unknown" in made.stderr or "unrecognized" in made.stderr:
        pytest.skip(f"{compiler} has no such option here")
    assert made.returncode == 0, made.stderr
    return run(folder, mode)


def run(folder: Path, mode: str) -> str:
    """What the compiled self-test finds in that mode."""
    done = subprocess.run([str(folder / "self_test"), mode], capture_output=True, text=True, check=False)
    if done.returncode == 77:
        pytest.skip(f"no way known to set {mode} here")
    return done.stdout.strip()


@needs_self_test
@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("compiler", [
    pytest.param(each, marks=[pytest.mark.nightly] if each != COMPILERS[0] else []) for each in COMPILERS])
@pytest.mark.parametrize(("options", "words"), [
    (SOUND, "0 sound"),
    ([*SOUND, *SILENCED["finite"]], "checks for NaN and infinity do not work"),
    ([*SOUND, *SILENCED["associative"]], "in another order"),
    ([*SOUND, *SILENCED["reciprocal"]], "by reciprocals"),
    ([*SOUND, *X87], "keep more digits"),
    ([*SOUND, "-ffp-contract=fast", "-mfma"], "are fused")], ids=["sound", *SILENCED, "x87", "fused"])
def test_every_option_that_spoils_arithmetic_is_found(options, words, compiler, real, tmp_path):
    if "-mfma" in options and not processor_has("fma"):
        pytest.skip("this processor fuses nothing")
    single = ["-DLACONIC_SINGLE"] if real == "single" else []
    assert words in found(compiler, [*options, *single], tmp_path)


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A function that gives the folder of a compiler's program with sound options; each is compiled once."""
    folders = {}

    def folder(compiler):
        if compiler not in folders:
            folders[compiler] = tmp_path_factory.mktemp(compiler)
            assert compiled(compiler, SOUND, folders[compiler]).returncode == 0
        return folders[compiler]

    return folder


@needs_self_test
@pytest.mark.parametrize("mode", ["up", "down", "zero", "ftz", "daz"])
@pytest.mark.parametrize("compiler", COMPILERS)
def test_every_mode_that_spoils_arithmetic_is_found(compiler, mode, sound):
    words = "flushed to zero" if mode in ("ftz", "daz") else "not rounded to nearest"
    assert words in run(sound(compiler), mode)


@needs_self_test
@pytest.mark.skipif("gcc" not in COMPILERS or not processor_has("avx2"), reason="needs gcc and a processor with FMA")
def test_what_a_vectoriser_fuses_against_its_orders_is_found_where_it_does(tmp_path):
    eager = ["-std=c99", "-O2", "-ffp-contract=off", "-march=x86-64-v3"]
    made = ["gcc", *eager, "-I", str(CORE / "include"), *FOLDERS, "-S", "-o", "-",
            str(CORE / "src/vehicle/geometry.c")]
    listing = subprocess.run(made, capture_output=True, text=True, check=True).stdout
    assert ("are fused" in found("gcc", eager, tmp_path)) == ("vfm" in listing)
    assert found("gcc", [*eager, "-fno-tree-slp-vectorize"], tmp_path) == "0 sound"


@needs_self_test
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize(("option", "told_by"), [
    ("-ffast-math", ("gcc", "clang")), ("-ffinite-math-only", ("gcc", "clang")),
    ("-funsafe-math-optimizations", ("gcc",)), ("-freciprocal-math", ("gcc",))])
def test_an_option_that_the_compiler_admits_does_not_compile(option, told_by, compiler, tmp_path):
    if compiler not in told_by:
        pytest.skip(f"{compiler} defines no macro for it; the self-test finds it")
    made = compiled(compiler, [*SOUND, option], tmp_path)
    assert made.returncode != 0
    assert "laconic: -f" in made.stderr
    assert "compile without it" in made.stderr


# ---- The purity check must be able to fail: each thing that the core must not do is shown to it once.

CHECK = Path(__file__).parents[4] / "cmake" / "check_purity.py"
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
needs_tools = pytest.mark.skipif(not (COMPILER and shutil.which("objdump")), reason="no compiler or no objdump")


def judge(folder: Path, text: str, *flags: str, build: bool = True) -> subprocess.CompletedProcess[str]:
    source = folder / "sample.c"
    source.write_text(text)
    command = [sys.executable, str(CHECK), "--sources", str(source)]
    if build:
        built = folder / "sample.o"
        subprocess.run([COMPILER, "-std=c99", "-c", *flags, str(source), "-o", str(built)], check=True)
        command += ["--objects", str(built)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@needs_tools
def test_a_pure_file_passes(tmp_path):
    text = '#include <stdint.h>\nstatic const int table[2] = {1, 2};\nint f(int i) { return table[i]; }\n'
    assert judge(tmp_path, text).returncode == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("#include <math.h>\n", "includes math.h"),
        ('#include "fmi3Functions.h"\n', "includes fmi3Functions.h"),
        ("#include SOME_HEADER\n", "by the macro SOME_HEADER"),
        ("double f(double x) { return __builtin_sqrt(x); }\n", "__builtin_sqrt"),
    ],
)
def test_a_source_that_reaches_outside_is_named(tmp_path, text, message):
    verdict = judge(tmp_path, text, build=False)
    assert verdict.returncode == 1
    assert message in verdict.stderr


@needs_tools
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("double sin(double); double f(double x) { return sin(x) + 1.0; }\n", "calls sin"),
        ("void *malloc(unsigned long); void *f(void) { return malloc(8); }\n", "calls malloc"),
        ("int counter = 3; int f(void) { return counter++; }\n", "writable data in .data"),
        ("int f(void) { static int n; return n++; }\n", "writable data in .bss"),
    ],
)
def test_an_object_that_reaches_outside_is_named(tmp_path, text, message):
    verdict = judge(tmp_path, text)
    assert verdict.returncode == 1
    assert message in verdict.stderr


@needs_tools
def test_fused_multiply_add_is_found(tmp_path):
    text = "double f(double a, double b, double c) { return a * b + c; }\n"
    flags = ["-O2", "-march=x86-64-v3", "-ffp-contract=fast"]
    probe = subprocess.run([COMPILER, *flags, "-E", "-x", "c", "/dev/null"], capture_output=True, check=False)
    if probe.returncode:
        pytest.skip("this compiler does not build for x86-64-v3")
    verdict = judge(tmp_path, text, *flags)
    assert verdict.returncode == 1
    assert "not the same bits" in verdict.stderr
