"""Environments for reinforcement learning on the batch core, by the interface of Gymnasium; docs/batch.md.

Importing this room registers `laconic/DriveToPose-v0`: gymnasium.make() gives one robot, make_vec() many in one batch.
"""

from __future__ import annotations

try:
    import gymnasium
except ModuleNotFoundError as error:
    from laconic.base.extras import missing_module
    raise missing_module(error) from None

from laconic.tools.learn.environments import DriveToPose as DriveToPose
from laconic.tools.learn.environments import DriveToPoseVector as DriveToPoseVector

ID, EPISODE_STEPS = "laconic/DriveToPose-v0", 300

gymnasium.register(ID, entry_point="laconic.tools.learn:DriveToPose", max_episode_steps=EPISODE_STEPS,
                   vector_entry_point="laconic.tools.learn:DriveToPoseVector")
