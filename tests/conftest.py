"""Hypothesis without deadlines (the first call compiles) and with the same examples on every machine."""

from hypothesis import settings

settings.register_profile("hydrotwin", deadline=None, derandomize=True, database=None, print_blob=True)
settings.load_profile("hydrotwin")
