"""The core for one scene alone, as C."""

from laconic.tools.trim.scene_files import Trimmed, needs_of, trimmed

__all__ = ["Trimmed", "needs_of", "trimmed"]
