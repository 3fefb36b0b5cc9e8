"""Set a gain only if the twin says that it is safe: look ahead from what is known of the rig now, then set it or not.

    python examples/refuse_gain.py rig 2.5           # beside `hydrotwin run sine --set duration=60 --listen ...`

Exit code 1: refused, nothing was set.
"""

import json
import subprocess
import sys

PROGRAM = (sys.executable, "-m", "bridge")
BANDS = ("valve travel <= 20", "peak p_lower <= 120 bar", "max error <= 20 mm")


def main(rig: str, gain: str, *link: str) -> int:
    """Ask, and set what is not refused; link: such as --connect ADDRESS."""
    change = f"controller.gain={gain}"
    expected = [word for band in BANDS for word in ("--expect", band)]
    asked = [*PROGRAM, "whatif", rig, "--set", change, "--horizon", "5 s", *expected, "--json", *link]
    answer = subprocess.run(asked, capture_output=True, text=True)
    if answer.returncode > 1 or not answer.stdout:
        print(answer.stderr.strip(), file=sys.stderr)
        return 2
    found = json.loads(answer.stdout)
    for band in found["bands"]:
        print(f"{band['band']}: kept in {band['kept']} of {band['futures']} futures")
    if not found["passed"]:
        print(f"{change} refused: nothing was set")
        return 1
    return subprocess.run([*PROGRAM, "set", rig, change, *link]).returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
