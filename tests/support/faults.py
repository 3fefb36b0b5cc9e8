"""Scenarios with faults, for tests."""

from bridge.scenario import Scenario, load

BAR = 1e5
BEGIN, END = 0.2, 0.5
WINDOW = f'at="{BEGIN} s", lasts="{END - BEGIN} s"'


def faulty(*faults: str, seed: int = 1, changes: tuple[str, ...] = (), duration: float = 0.7) -> Scenario:
    """The step at 0.1 s."""
    own = ("reference.at=0.1", f"seed={seed}", f"duration={duration}", "expect=[]", f"fault=[{', '.join(faults)}]")
    return load("step", [*own, *changes])


def one(target: str, kind: str, sizes: str = "", when: str = WINDOW) -> str:
    """A fault as a scenario has it."""
    return f'{{target="{target}", kind="{kind}", {when}{", " if sizes else ""}{sizes}}}'
