"""What the node costs on each board: flash, RAM, worst stack, instructions per frame and per step.

The stack is read from the machine code: what each function pushes and reserves, along the deepest chain of calls. A
call through a pointer may reach any function of an integrator whose address stands in the image's constants. Interrupts
come on top. Frames too large for an instruction of the M0 come from a literal that is added to the stack pointer.
"""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from laconic.base.paths import built
from laconic.can.rig.boards import QEMU
from laconic.can.rig.choices import BOARDS
from laconic.errors import BadInput

OBJDUMP, SIZE = "arm-none-eabi-objdump", "arm-none-eabi-size"
EXCEPTION_FRAME = {"an385": 32, "microbit": 32}  # without FPU; with: 104
METHOD_FUNCTION = re.compile(r"^(?!laconic_|on_).*_(prepare|increment|step)(\.|$)")  # what laconic_method points to
PROTOCOL_FUNCTION = re.compile(r"^(start|on_frame|on_step|next_frame)(\.|$)")  # what laconic_drive_protocol points to
NODE_FUNCTION = re.compile(r"^laconic_(node|drives)_")  # these call what a port links, and protocols
REGISTER_BYTES = {"s": 4, "d": 8}


@dataclass
class Function:
    """One function of an image."""

    name: str
    address: int
    frame: int = 0
    calls: set[str] = field(default_factory=set)
    calls_pointer: bool = False


@dataclass(frozen=True)
class Cost:
    """Of one image."""

    board: str
    flash: int
    static_ram: int
    stack: int
    instructions: dict[str, int]


def tool(*command: str) -> str:
    """Output of a tool of the cross compiler."""
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout
    except FileNotFoundError:
        raise BadInput(f"no {command[0]} here: install binutils-arm-none-eabi") from None


def functions_of(image: Path) -> dict[str, Function]:
    """All functions with their frames and calls."""
    found: dict[str, Function] = {}
    current = Function("", 0)
    lines = tool(OBJDUMP, "-d", "--no-show-raw-insn", str(image)).splitlines()
    words = dict(re.findall(r"\s*([0-9a-f]+):\s+\.word\s+(0x[0-9a-f]+)", "\n".join(lines)))
    literals: dict[str, int] = {}
    for line in lines:
        if literal := re.search(r"ldr\s+(r\d+), \[pc.*@ \(([0-9a-f]+) ", line):
            literals[literal[1]] = int(words.get(literal[2], "0"), 16)
        elif (added := re.search(r"add\s+sp, (r\d+)", line)) and literals.get(added[1], 0) >> 31:
            current.frame += 2**32 - literals[added[1]]  # negative: the stack grows
        if header := re.match(r"([0-9a-f]{8}) <(\S+)>:", line):
            current = found.setdefault(header[2], Function(header[2], int(header[1], 16)))
        elif code := re.match(r"\s*[0-9a-f]+:\s+(\S+)\s*(.*)", line):
            read_instruction(current, code[1], code[2])
    return found


def read_instruction(function: Function, name: str, operands: str) -> None:
    """What one instruction means for the stack."""
    if name.startswith("push") or (name.startswith("stmdb") and operands.startswith("sp!")):
        function.frame += 4 * count_registers(operands)
    elif name.startswith("vpush"):
        function.frame += REGISTER_BYTES[operands[1]] * count_registers(operands)
    elif amount := re.fullmatch(r"sub\S* sp, (?:sp, )?#(\d+).*|str\S* .*\[sp, #-(\d+)\]!.*", f"{name} {operands}"):
        function.frame += int(amount[1] or amount[2])
    elif re.match(r"(blx|bx?) (r\d+|ip)$", f"{name} {operands}".strip()):
        function.calls_pointer = True
    elif name.startswith("b") and (target := re.search(r"<([^+>]+)>", operands)) and target[1] != function.name:
        function.calls.add(target[1])


def count_registers(operands: str) -> int:
    """Registers in {r4, r6-r8, lr}."""
    total = 0
    for part in re.findall(r"\{(.*)\}", operands)[0].split(","):
        ends = re.findall(r"\d+", part)
        total += int(ends[1]) - int(ends[0]) + 1 if "-" in part else 1
    return total


def pointed_to(image: Path, functions: dict[str, Function]) -> set[str]:
    """Functions whose address stands somewhere in the image's words."""
    words = set()
    for line in tool(OBJDUMP, "-s", str(image)).splitlines():
        if row := re.match(r" [0-9a-f]+ ((?:[0-9a-f]{8} ?)+)", line):
            words |= {int.from_bytes(bytes.fromhex(word), "little") for word in row[1].split()}
    return {name for name, f in functions.items() if f.address | 1 in words and METHOD_FUNCTION.search(name)}


def deepest(name: str, functions: dict[str, Function], pointers: set[str], done: dict[str, int],
            path: tuple[str, ...] = ()) -> int:
    """Bytes of stack that a function and all it calls can take. `auto` calls one other method through a pointer, and
    no method calls a third; any recursion without a pointer is refused."""
    if name in done:
        return done[name]
    function = functions.get(name, Function(name, 0))
    if name in path and not pointers & set(path):
        raise BadInput(f"{' → '.join((*path, name))}: recursion, so the stack has no bound")
    calls = set(function.calls)
    if function.calls_pointer and len(pointers & {*path, name}) < 2:
        calls |= of_port(functions) if NODE_FUNCTION.match(name) else pointers
    calls -= {*path, name}
    below = max((deepest(each, functions, pointers, done, (*path, name)) for each in calls), default=0)
    if not pointers & set(path):
        done[name] = function.frame + below
    return function.frame + below


def of_port(functions: dict[str, Function]) -> set[str]:
    """What the node calls through pointers: how a port finds methods and protocols, and a protocol's functions."""
    return {"port_method", "port_protocol"} | {name for name in functions if PROTOCOL_FUNCTION.match(name)}


def worst_stack(image: Path, board: str) -> int:
    """Main and the deepest interrupt on top of it."""
    functions = functions_of(image)
    pointers, done = pointed_to(image, functions), dict[str, int]()
    interrupts = max(deepest(name, functions, pointers, done) for name in functions if name.endswith("_handler"))
    main = deepest("board_reset", functions, pointers, done)
    return main + EXCEPTION_FRAME.get(board, 104) + interrupts


def instructions_of(board: str) -> dict[str, int]:
    """Counted by the board itself under QEMU."""
    image = built(f"firmware/count-{board}.elf")
    command = (QEMU, "-M", BOARDS[board].machine, "-kernel", str(image), "-display", "none", "-monitor", "none",
               "-serial", "none", "-icount", "shift=8", "-semihosting-config", "enable=on,target=native")
    result = subprocess.run(command, capture_output=True, text=True, timeout=60)
    if result.returncode:
        raise BadInput(f"{image.name}: the count failed: {result.stdout} {result.stderr}")
    return {name: int(value) for name, value in re.findall(r"(\w+) (\d+)", result.stdout + result.stderr)}


def cost_of(board: str) -> Cost:
    """All figures of one board."""
    image = built(f"firmware/laconic-node-{board}.elf")
    text, data, bss = (int(n) for n in tool(SIZE, str(image)).splitlines()[1].split()[:3])
    counted = instructions_of(board) if "-" not in board else {}
    return Cost(board, text + data, data + bss, worst_stack(image, board), counted)
