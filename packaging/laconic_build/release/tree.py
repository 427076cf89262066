"""The commit that a release is of: its files, its date, and what differs from it."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from laconic_build.release.archives import File
from laconic_build.wheel.archive import epoch


class NoRelease(Exception):
    """Why no release can be made; one line."""


def check_tools(wasm_clang: str, cross: Path) -> None:
    """NoRelease that names all that is missing here, so that one installation brings it; `cross` is an environment."""
    tools = {"git": shutil.which("git"), "a clang with WebAssembly": shutil.which(wasm_clang),
             "its linker wasm-ld": shutil.which("wasm-ld") or shutil.which(str(Path(wasm_clang).with_name("wasm-ld"))),
             "the compiler for other platforms (the build fetches ziglang)":
                 next(cross.glob("lib/python3*/site-packages/ziglang"), None)}
    if lacking := [name for name, found in tools.items() if found is None]:
        raise NoRelease(f"this machine lacks {', '.join(lacking)}; install what is missing (Debian: apt install git "
                        "clang lld) and build the target laconic_release again")


@dataclass(frozen=True)
class Tree:
    """The project's folder as a commit has it."""

    folder: Path
    commit: str
    epoch: int  # seconds since 1970: SOURCE_DATE_EPOCH, else the commit's
    programs: frozenset[str]
    files: tuple[str, ...]
    changed: tuple[str, ...]  # what no commit holds as it is here

    def read(self, below: str = "") -> dict[str, File]:
        """The files whose paths begin so, by their paths."""
        return {name: File((self.folder / name).read_bytes(), name in self.programs)
                for name in self.files if name.startswith(below)}


def tree_of(folder: Path) -> Tree:
    """NoRelease where git does not know the folder: then nothing states what belongs to the sources."""
    told = git(folder, "ls-files", "--stage", "-z").split("\0")[:-1]
    modes = {line.partition("\t")[2]: line[:6] for line in told}
    changed = git(folder, "status", "--porcelain", "-z", "--no-renames").split("\0")[:-1]
    return Tree(folder, git(folder, "rev-parse", "HEAD").strip(), epoch(folder),
                frozenset(name for name, mode in modes.items() if mode == "100755"),
                tuple(name for name in sorted(modes) if (folder / name).is_file()),
                tuple(sorted(line[3:] for line in changed)))


def git(folder: Path, *words: str) -> str:
    """What git prints."""
    try:
        done = subprocess.run(["git", "-C", str(folder), *words], capture_output=True, text=True, check=False)
    except OSError as why:
        raise NoRelease(f"git cannot be started ({why.strerror}); install it") from None
    if done.returncode:
        raise NoRelease(f"{folder}: is no checkout of git, which alone knows what belongs to the sources; clone the "
                        f"project ({done.stderr.strip().splitlines()[-1] if done.stderr.strip() else 'git failed'})")
    return done.stdout
