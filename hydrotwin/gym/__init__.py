"""The rig as an environment of Gymnasium: docs/gymnasium.md. `pip install 'hydrotwin[gym]'`.

Importing this registers "hydrotwin/Rig-v0" for `gymnasium.make`.
"""

from hydrotwin.gym.reward import Step, Tracking
from hydrotwin.gym.rig import ID, Rig
from hydrotwin.policy import LIMIT, SIZES, law

__all__ = ["ID", "LIMIT", "SIZES", "Rig", "Step", "Tracking", "law"]
