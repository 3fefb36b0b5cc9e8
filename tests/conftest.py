"""Hypothesis without deadlines (the first call compiles) and with the same examples on every machine; the watchdog."""

from hypothesis import settings

from tests.support.watchdog import (  # noqa: F401  pytest finds these here
    pytest_collection_modifyitems,
    pytest_configure,
    pytest_timeout_cancel_timer,
    pytest_timeout_set_timer,
    pytest_unconfigure,
)

settings.register_profile("hydrotwin", deadline=None, derandomize=True, database=None, print_blob=True)
settings.load_profile("hydrotwin")
