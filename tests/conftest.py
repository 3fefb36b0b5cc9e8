"""Hypothesis without deadlines (the first call compiles) and with the same examples on every machine; the watchdog.

Signals that whoever started pytest ignores, as a shell does for a command in the background or `nohup`, have their
default meaning here: the processes that tests start and end inherit it.

What collecting 5000 tests has made stays as long as the process: the garbage collector does not look at it again.
"""

import gc
import signal

from hypothesis import settings

pytest_plugins = ("tests.support.watchdog",)

settings.register_profile("long", deadline=None, derandomize=True, database=None, print_blob=True)
settings.register_profile("short", settings.get_profile("long"), max_examples=40)
settings.load_profile("short")

for _number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(_number, signal.default_int_handler if _number == signal.SIGINT else signal.SIG_DFL)


def pytest_collection_finish() -> None:
    gc.collect()
    gc.freeze()
