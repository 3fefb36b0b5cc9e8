"""The stamp in a recorded measurement: a fault of the link may have let the message come later."""

import struct

from bridge.recording.entries import Entry

_STAMP = struct.Struct("<28xq")  # header, run, sequence and tick before it


def stamp_in(entry: Entry) -> int:
    """When a measurement was taken [ns], without decoding the rest."""
    return _STAMP.unpack_from(entry.data)[0]
