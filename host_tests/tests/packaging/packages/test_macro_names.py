"""Names of core and node against macros of platforms: a file that such macros stand before compiles as without them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR, built

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

pytestmark = pytest.mark.skipif(not COMPILERS, reason="neither gcc nor clang")


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


def test_the_two_files_compile_behind_every_platforms_macros(macros):
    compiled(macros, [built("amalgamation")], [built("amalgamation/laconic.c")])
    compiled(macros, [built("amalgamation")], [built("amalgamation/laconic_single.c")])


@pytest.mark.parametrize("part", ["articulated", "articulated_friction", "batch", "derivatives", "estimate", "filter",
                                  "soft_double"])
def test_each_optional_part_of_the_core_does(part, macros):
    files = [path for path in sorted((CORE / "optional" / part).glob("*.c")) if path.name != "check_double.c"]
    optional = [CORE / "optional" / name for name in ("articulated", "derivatives")]
    compiled(macros, [*FOLDERS, *optional], files)


def test_the_node_its_drives_and_the_gate_do(macros):
    folders = [*FOLDERS, NODE / "include", NODE / "node", NODE / "drives"]
    files = [path for part in ("node", "wire", "secure", "drives") for path in (NODE / part).glob("**/*.c")]
    compiled(macros, [*folders, built("firmware_stub/wire")], sorted(files), "-DLACONIC_NODE_WITH_ESTIMATE=1")
