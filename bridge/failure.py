"""What ends a run badly."""


class RunError(Exception):
    """The run cannot go on; the text names who or what, and when."""
