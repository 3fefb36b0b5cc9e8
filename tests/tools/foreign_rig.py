"""What the twin says of the logs of another rig, against what was changed in them: the table of docs/identify.md.

python -m tests.tools.foreign_rig FOLDER             fits the nominal rig, then names what has changed in each other log
python -m tests.tools.foreign_rig FOLDER --rig nominal.toml --logs 'leak-*'         from a nominal rig fitted before

FOLDER holds logs as `examples/import/foreign-rig.toml` maps them, CHANGE-EXCITATION.csv.gz. Every log is judged as the
guide says: each number fitted alone to it, the one that explains most named, and fitted over the whole log.
"""

import argparse
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from bridge.cli.fitted import write_fitted
from bridge.cli.tables import print_table
from bridge.recording.logs.importing import import_log
from bridge.scenario import load
from bridge.studies.identification.identify import Judged, Wanted, identify
from bridge.studies.sweep.engine import HERE

EXAMPLES = Path(__file__).parents[2] / "examples" / "import"
NOMINAL, FITTED = "nominal", "nominal-ol_steps"
OF_THE_RIG = (
    "rig.load.mass,rig.cylinder.leakage_resistance,rig.friction.coulomb,rig.friction.viscous,"
    "rig.servo_valve.rated_flow,rig.oil.bulk_modulus"
)
MAY_CHANGE = f"{OF_THE_RIG},rig.servo_valve.null_bias,rig.fixed_pump.leakage"
TRUTH = {  # of the logs whose change is known: number, value [SI]
    "mass-260kg": ("rig.load.mass", 260.0),
    "leak-x20": ("rig.cylinder.leakage_resistance", 5e11),
}


def imported(log: Path, folder: Path) -> Path:
    """A log as a recording."""
    path = folder / f"{log.name.removesuffix('.csv.gz')}.mcap"
    import_log(log, EXAMPLES / "foreign-rig.toml", path)
    return path


def wanted(rig: str, files: Sequence[Path], judge: Sequence[Path], fit: str, each: bool) -> Wanted:
    """As the command line of the guide asks."""
    plain = load(rig).model_dump(mode="json")
    return Wanted(tuple(map(str, files)), tuple(map(str, judge)), plain, (fit,), moving=True, each=each)


def nominal(logs: Sequence[Path], folder: Path) -> str:
    """Fit the nominal rig to one log and judge it on the others; the scenario file of it."""
    own = [log for log in logs if log.name.startswith(NOMINAL)]
    files = {log.name.removesuffix(".csv.gz"): imported(log, folder) for log in own}
    fitted, rig = files.pop(FITTED), str(EXAMPLES / "servo-axis.toml")
    found = identify(wanted(rig, [fitted], list(files.values()), OF_THE_RIG, False), 1, None, HERE)
    print_table(("recording", "signal", "rms left", "of the motion", "times the noise"), shares(found))
    return str(write_fitted(found, rig, [], folder / "nominal.toml"))


def shares(found: Judged) -> Iterator[tuple[str, ...]]:
    """What is left of each signal that moves, on the fitted recording and on those it is judged on."""
    for one in (*found.known.whiteness, *found.judged):
        yield one.record, one.signal, f"{one.rms:.3g} {one.unit}", f"{one.share:.2%}", f"{one.deviations:.2f}"


def verdict(log: Path, rig: str, folder: Path) -> tuple[str, ...]:
    """A row: what has changed, by the fit and in truth."""
    found = identify(wanted(rig, [imported(log, folder)], [], MAY_CHANGE, True), 1, None, HERE)
    order: Any = found.ranked
    one = found.known.estimates[0]
    named = one.parameter.name if order.best else "nothing"
    low, high = (one.parameter.words(end) for end in one.interval)
    name, true = TRUTH.get(log.name.rpartition("-")[0], ("", 0.0))
    truth = one.parameter.words(true) if name == one.parameter.name else name or "no number of these"
    left = f"{order.tried[0].left:.2f}, {order.tried[1].left:.2f}, {order.before:.2f}"
    return log.name.removesuffix(".csv.gz"), named, one.parameter.words(one.value), f"{low} .. {high}", truth, left


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rig", help="the nominal rig as fitted before  [default: fit it]")
    parser.add_argument("--logs", default="*", help="only these")
    options = parser.parse_args()
    logs = sorted(options.folder.glob("*.csv.gz"))
    head = ("recording", "changed", "to", "95 % interval", "in truth", "times the noise: best, next, at first")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rig = options.rig or nominal(logs, folder)
        rows = []
        for log in sorted(options.folder.glob(f"{options.logs}.csv.gz")):
            if not log.name.startswith((NOMINAL, "drift-none")) or options.logs != "*":
                rows.append(verdict(log, rig, folder))
                print(" | ".join(rows[-1]), flush=True)
        print_table(head, rows)


if __name__ == "__main__":
    main()
