"""The swing of a sampled relay, predicted by the reduced drive, beside that of the twin.

    python -m tests.benchmarks.relay_cycles 12        so many random loops: mass, period, delay, step, both valves

Printed are peak to peak and frequency of both, and the shares within 20 %.
"""

import argparse
import random

from bridge.scenario import Scenario, load
from bridge.studies.stability.amplitude import loop_of, swing
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.trial import trial
from bridge.studies.stability.twin_edge import stepped
from controller.stability.amplitude.swing import last_third
from tests.benchmarks.swing_edges.cases import DELAYS, MASSES, PERIODS, STEPS


def main() -> None:
    """Print the loops and the shares."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("loops", type=int)
    chance, near, often = random.Random(1), [], []
    print("valve         mass  period  delay  step   peak to peak: theory, twin   frequency: theory, twin")
    for number in range(parser.parse_args().loops):
        valve = ("proportional", "switching")[number % 2]
        scenario, size, loop = chosen(chance, valve)
        trace = trial(stepped(scenario, size), stand_of(scenario))
        twin, theory = last_third(trace.time, trace.position), swing(loop_of(scenario), 1.0, size)
        near.append(abs(theory.peak_to_peak - twin.peak_to_peak) <= 0.2 * twin.peak_to_peak)
        if twin.frequency > 0.0:
            often.append(abs(theory.frequency - twin.frequency) <= 0.2 * twin.frequency)
        peaks = f"{theory.peak_to_peak * 1e3:10.3g}, {twin.peak_to_peak * 1e3:<10.3g} mm"
        print(f"{valve:12}  {loop}  {peaks:26}   {theory.frequency:6.3g}, {twin.frequency:.3g} Hz")
    print(f"peak to peak within 20 %: {sum(near)} of {len(near)}; frequency: {sum(often)} of {len(often)}")


def chosen(chance: random.Random, valve: str) -> tuple[Scenario, float, str]:
    """A loop, the size of its step [m], and both in words."""
    mass, period, size = chance.choice(MASSES), chance.choice(PERIODS), chance.choice(STEPS)
    delay = round(chance.choice(DELAYS) * period / 0.05) * 0.05
    times = [f"loop.sample_period={period}ms", f"loop.delay={delay}ms"]
    timeout = f"loop.command_timeout={max(0.1, 0.01 * period)}"
    scenario = load("relay", [*times, timeout, f"rig.load.mass={mass}", f"rig.valve.kind={valve}"])
    return scenario, size * 1e-3, f"{mass:4}  {period:4} ms  {delay:5.1f}  {size:+4}"


if __name__ == "__main__":
    main()
