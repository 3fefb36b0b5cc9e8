"""What ends a run badly, and what keeps it from starting."""


class RunError(Exception):
    """The run cannot go on; the text names who or what, and when."""


class ScenarioError(Exception):
    """A scenario, or something else that was asked for, that cannot be used; its text has one line per mistake."""
