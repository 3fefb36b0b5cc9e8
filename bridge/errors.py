"""What ends a run badly, and what keeps it from starting."""


class RunError(Exception):
    """The run cannot go on; the text names who or what, and when."""


class UsageError(Exception):
    """Something was asked for that cannot be done; the text has one line per mistake, each with the way out."""


class ScenarioError(UsageError):
    """A scenario that cannot be used."""
