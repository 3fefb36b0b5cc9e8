"""Memory that a process has freed, given back to the system."""

import ctypes


def give_back() -> None:
    """What the C library keeps for later, where it has a call for that: glibc alone, some milliseconds."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
