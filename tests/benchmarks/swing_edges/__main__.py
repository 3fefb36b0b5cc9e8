"""The table of edges: those of the twin, on recorded maps of its runs, beside the intervals of `hydrotwin advise`.

    python -m tests.benchmarks.swing_edges edges.csv                  measure what is missing, then print shares
    python -m tests.benchmarks.swing_edges edges.csv --most 20        the first 20 cases of each law, both masses alike
    python -m tests.benchmarks.swing_edges edges.csv --law pid        of some laws; may be repeated
    python -m tests.benchmarks.swing_edges edges.csv --seconds 500    stop after so long; the next call goes on
    python -m tests.benchmarks.swing_edges edges.csv --part 0/2       every other case, for two processes
    python -m tests.benchmarks.swing_edges edges.csv --shares         print the shares of what is there
    python -m tests.benchmarks.swing_edges edges.csv --rows           and each case

A case is a law, mass, sampling period, delay and step. Its map, runs of the twin 5 % apart over the whole band of gains
that settles and beyond (`gain_map`), is made without a look at what `advise` says and kept in edges.maps. Intervals are
kept in edges.csv, so after a change of `advise` they alone are measured again. The edge is where the map's band
ends, as its definition says: the lowest gain that swings, and where small gains swing, too, the ends of the widest
stretch that settles. "In doubt" also counts the edges of a limit on the swing that is by MARGIN lower and higher: as
uncertain as the peak to peak of one run is. "On half of the map": of every other gain, 10 % apart; how much such an
edge is chance. Cases come in a random but fixed order, so that a table that is not finished is a fair sample. Two
processes may append to the same files. Shares have Wilson's intervals of 95 %.
"""

import argparse
import math
import time
from collections.abc import Sequence
from pathlib import Path

from tests.benchmarks.swing_edges import gain_map, table
from tests.benchmarks.swing_edges.cases import LAWS, Case, cases, first_of_each

ALL = ("pd",)


def fill(path: Path, wanted: Sequence[Case], seconds: float) -> None:
    """Measure what is missing, until the time is up."""
    begun, maps = time.monotonic(), path.with_suffix(".maps")
    for case in wanted:
        if case not in table.known(path):
            table.write(path, case, table.asked(case))
        if case not in gain_map.read(maps):
            gain_map.write(maps, case, gain_map.record(case))
        if time.monotonic() - begun > seconds:
            return


def main() -> None:
    """Fill the table and print what it says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", type=Path)
    parser.add_argument("--seconds", type=float, default=math.inf)
    parser.add_argument("--most", type=int)
    parser.add_argument("--part", default="0/1")
    parser.add_argument("--law", action="append", choices=LAWS)
    parser.add_argument("--shares", action="store_true")
    parser.add_argument("--rows", action="store_true")
    asked = parser.parse_args()
    part, parts = map(int, asked.part.split("/"))
    if not (asked.shares or asked.rows):
        laws = tuple(asked.law or ALL)
        wanted = cases(laws) if asked.most is None else first_of_each(laws, asked.most)
        fill(asked.csv, wanted[part::parts], asked.seconds)
    rows = table.joined(table.known(asked.csv), gain_map.read(asked.csv.with_suffix(".maps")))
    if asked.rows:
        table.print_rows(rows)
    table.print_shares(rows)


if __name__ == "__main__":
    main()
