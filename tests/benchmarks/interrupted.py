"""How long a verb that computes goes on after Ctrl-C: from the signal to the end of the command and of all it started.

    python -m tests.benchmarks.interrupted                all verbs
    python -m tests.benchmarks.interrupted map advise     those that begin with these words

Each is interrupted at several moments of its work; where the command had ended by then, "over" stands.
"""

import signal
import sys
import tempfile
from pathlib import Path

from tests.support.endings import end

GOAL = 1.0  # [s]
RECORDED = "recorded.mcap"  # of 60 s, for the verbs that read
COMMANDS: dict[str, tuple[float, ...]] = {  # and when [s] they are interrupted
    "run step --mode inprocess --duration 2000": (1.0, 3.0, 8.0),
    "run step --mode lockstep --duration 600": (3.0, 8.0),
    "run step --duration 600": (3.0, 8.0),
    "check step slow-sampling delay": (1.5, 4.0),
    "advise step": (1.5, 5.0, 9.0),
    "advise step --verify": (1.5, 12.0),
    "advise step --set loop.delay=10": (1.5, 4.0),
    "describe impingement": (0.7,),
    "convergence step": (1.5, 5.0),
    "sweep step controller.gain=1:4:400": (1.5, 6.0),
    "tune step --vary controller.gain=1:4": (1.5, 6.0),
    "map": (0.8, 3.0),
    "map --simulate": (2.0, 6.0),
    "map delay gain --rig delay": (2.0, 8.0),
    "figure 5.21": (3.0, 9.0),
    "figure 5.4": (1.5, 4.0),
    "figure causes": (3.0, 9.0),
    "figure areas": (1.5, 3.0),
    "figure 2.28": (2.0, 5.0),
    "figure lyapunov": (1.5, 4.0),
    "figure basin": (1.5, 4.0),
    "figures --all": (3.0, 12.0),
    "line --scheme chebyshev/esdirk5 --tolerance 1e-9 --span 20s": (1.5, 4.0),
    "valve static": (0.8,),
    "valve chatter --flow 10": (0.8,),
    "valve chart": (1.5, 4.0),
    f"report {RECORDED}": (1.0, 3.0),
    f"view {RECORDED} --save view.rrd": (1.0, 3.0),
    f"export {RECORDED} --csv out": (0.8, 2.0),
    f"compare {RECORDED} {RECORDED}": (0.8, 1.5),
    f"digest {RECORDED}": (0.6,),
    f"info {RECORDED}": (0.6,),
    f"recover {RECORDED} -o again.mcap": (0.6, 1.5),
    f"replay {RECORDED} --into plant": (1.5, 4.0),
    f"replay {RECORDED} --into controller": (1.5, 4.0),
    "doctor": (1.5, 4.0),
}


def main() -> None:
    """Print a row per verb and the worst of them."""
    wanted = sys.argv[1:]
    chosen = {w: m for w, m in COMMANDS.items() if not wanted or any(w.startswith(begin) for begin in wanted)}
    worst: list[tuple[float, str]] = []
    with tempfile.TemporaryDirectory() as folder:
        _record(Path(folder), chosen)
        for words, moments in chosen.items():
            found = [_latency(words, moment, Path(folder)) for moment in moments]
            print(f"{words:60}", "  ".join(_in_words(m, f) for m, f in zip(moments, found, strict=True)), flush=True)
            worst += [(seconds, words) for seconds in found if seconds is not None]
    for seconds, words in sorted(worst, reverse=True)[:5]:
        print(f"{seconds:.2f} s{'' if seconds <= GOAL else ' (goal missed)'}: {words}")


def _record(folder: Path, chosen: dict[str, tuple[float, ...]]) -> None:
    """What the reading verbs read."""
    if any(RECORDED in words for words in chosen):
        record = f"run step --mode inprocess --duration 60 --json - --record {RECORDED}"
        end([*record.split()], signal.SIGCONT, 0.0, folder, patience=120.0)


def _latency(words: str, moment: float, folder: Path) -> float | None:
    """Seconds until all is gone; None where the command had ended."""
    found = end(words.split(), signal.SIGINT, moment, folder)
    return None if found.code == 0 and found.latency < 0.01 else found.all_gone


def _in_words(moment: float, seconds: float | None) -> str:
    return f"at {moment:g} s: " + ("over" if seconds is None else f"{seconds:.2f}")


if __name__ == "__main__":
    main()
