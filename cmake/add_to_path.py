"""Make a folder importable in the environment whose Python runs this: a path file there, read at each start, names it.

    python add_to_path.py build/peers
"""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path


def main(folder: Path) -> None:
    """Writes the path file, which is called after the folder."""
    site_packages = Path(sysconfig.get_path("purelib"))
    (site_packages / f"laconic_{folder.name}.pth").write_text(f"{folder.resolve()}\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
