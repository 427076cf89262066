"""python -m laconic_build.page npm|page …: what CMake calls, from web/npm and page; figures …: what the page costs."""

from __future__ import annotations

import argparse
from pathlib import Path

from laconic_build.page.figures import page_figures
from laconic_build.page.npm import make_package
from laconic_build.page.page import make_page


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m laconic_build.page", description=__doc__)
    commands = parser.add_subparsers(required=True)
    npm = commands.add_parser("npm", help="the npm package: a folder and its archive")
    npm.add_argument("--version", required=True)
    npm.add_argument("--archive", type=Path, required=True)
    npm.set_defaults(make=lambda a: make_package(a.sources, a.wasm, a.hinged_wasm, a.version, a.out, a.archive))
    page = commands.add_parser("page", help="the page, one HTML file")
    page.add_argument("--binding", type=Path, required=True, help="folder src of the npm package that was made")
    page.add_argument("--scenes", type=Path, required=True)
    page.add_argument("--native-hash", type=Path, required=True, help="what the native trajectory_hash printed")
    page.set_defaults(make=lambda a: make_page(a.sources, a.binding, a.scenes, a.native_hash, a.out))
    npm.add_argument("--wasm", type=Path, required=True)
    npm.add_argument("--hinged-wasm", type=Path, required=True)
    for command in (npm, page):
        command.add_argument("--sources", type=Path, required=True)
        command.add_argument("--out", type=Path, required=True)
    figures = commands.add_parser("figures", help="size, frames a second and time of a frame, in Chromium")
    figures.add_argument("page", type=Path)
    figures.add_argument("--seconds", type=float, default=6.0, help="of each measurement (default 6)")
    figures.add_argument("--scene", default="kuka_youbot", help="whose own drive is played (default kuka_youbot)")
    figures.add_argument("--json", action="store_true", help="for programs")
    figures.set_defaults(make=lambda a: page_figures(a.page, a.seconds, a.scene, a.json))
    arguments = parser.parse_args()
    arguments.make(arguments)


main()
