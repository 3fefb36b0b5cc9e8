"""What people should know of a run, without its being a failure."""

from bridge.recording.imported import measured_in_words
from bridge.recording.reader import Recording
from bridge.wire.messages import EventKind


def remarks(recording: Recording) -> list[str]:
    """What a foreign controller lacked, and whether plant and controller ran different scenarios; one sentence each."""
    lacks = recording.metadata.get("recorder", {}).get("lacks", [])
    events = recording.messages("event") if "event" in recording.counts else []
    mixed = [event.text for event in events if event.kind == EventKind.DIFFERS]
    return [
        *measured_in_words(recording),
        *dict.fromkeys(mixed),
        *(str(lack) for lack in lacks if isinstance(lacks, list)),
    ]
