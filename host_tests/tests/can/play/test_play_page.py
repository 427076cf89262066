"""docs/play.md is true: its maps and keys are read, and what it lists is all there is."""

from __future__ import annotations

import re
from pathlib import Path

from laconic.base.paths import SCENE_DIR, SOURCE_DIR
from laconic.can.play.checksums import CHECKSUMS
from laconic.can.play.fault_kinds import KINDS
from laconic.can.play.map_file import AT_TIMEOUT, read_map
from laconic.can.play.map_signals import BODY_OUTPUTS, DRIVE_OUTPUTS, OF_DRIVES, WHEEL_OUTPUTS
from laconic.can.play.settings import drive_settings
from laconic.scene import read_scene
from laconic.scene.drives import DRIVE_PROTOCOLS, NUMBERS
from laconic.scene.signals import LENGTHS, PER_WHEEL

PAGE = (SOURCE_DIR / "docs" / "play.md").read_text(encoding="utf-8")
TABLES = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)


def test_the_map_of_the_page_is_one_that_is_read(tmp_path: Path) -> None:
    path = tmp_path / "page.toml"
    path.write_text("\n".join(text for text in TABLES if "[[" in text), encoding="utf-8")
    found = read_map(path, 4)
    assert [each.message for each in found.received] == ["WHEEL_COMMAND"] and len(found.sent[0].joints) == 2


def test_the_drives_of_the_page_are_ones_that_are_read_with_every_key(tmp_path: Path) -> None:
    drives, = (text for text in TABLES if "[rig.drives]" in text)
    path = tmp_path / "page.toml"
    text = (SCENE_DIR / "example_two_wheel_sizes.toml").read_text(encoding="utf-8")
    path.write_text(text + "\n" + drives.replace('"canopen"', '"odrive"'), encoding="utf-8")
    found = drive_settings(read_scene(path), None)
    assert found.driven == (True, True, False, False) and set(found.numbers) == set(NUMBERS)
    assert set(found.origins.values()) == {"rig.drives"}


def test_every_name_that_a_map_or_an_option_may_have_stands_on_the_page() -> None:
    names = {*CHECKSUMS, *KINDS, *AT_TIMEOUT, *BODY_OUTPUTS, *DRIVE_OUTPUTS, *WHEEL_OUTPUTS, *OF_DRIVES, *LENGTHS,
             *PER_WHEEL, *DRIVE_PROTOCOLS, *NUMBERS}
    assert {name for name in names if name not in PAGE} == set()
