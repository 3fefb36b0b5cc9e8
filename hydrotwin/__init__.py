"""Run scenarios, laws of your own among them, from Python: docs/python.md.

What is imported from here stays as it is from one minor version to the next; `bridge`, `twin` and `controller` may
move.
"""

from bridge.errors import RunError, UsageError
from bridge.scenario import Scenario, ScenarioError
from controller.bands import Metrics
from controller.law import Sample, compensate, saturate
from controller.reference import Target
from hydrotwin.runs import Run, linear_model, load, read, run
from hydrotwin.signal import Signal
from hydrotwin.sweeps import Sweep, sweep

__all__ = [
    "Metrics",
    "Run",
    "RunError",
    "Sample",
    "Scenario",
    "ScenarioError",
    "Signal",
    "Sweep",
    "Target",
    "UsageError",
    "compensate",
    "linear_model",
    "load",
    "read",
    "run",
    "saturate",
    "sweep",
]
