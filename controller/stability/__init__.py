"""When a loop oscillates: linear theory of the analogue, the relay and the sampled loop."""

from controller.stability.sampled import critical_gain, monodromy

__all__ = ["critical_gain", "monodromy"]
