"""A robot described for other tools (URDF, xacro, MJCF, SDF) becomes a scene: `import_robot`.

A reader for each format makes one tree of links and joints (`robot_tree`); what follows knows no format: wheels are
found (`wheels`, `rollers`), then what else stands on the ground (`supports`), all masses are added up (`rigid_body`),
and the scene is written with a comment for everything that the file does not tell (`imported_scene`).
"""

from laconic.robot.importer.answers import Answers
from laconic.robot.importer.imported_scene import Imported, import_robot

__all__ = ["Answers", "Imported", "import_robot"]
