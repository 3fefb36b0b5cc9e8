"""Units in the heads of columns: "p [bar]", "p (bar)", "p in bar", "p / bar", "position_mm", "p_A_Pa_abs"."""

import re

from bridge.scenario.units import ABSOLUTE, UNITS, Unit, spelled

PLAIN = {name: (si, unit) for si, units in UNITS.items() for name, unit in units.items() if si != "1/s"}
PLAIN |= {name: ("Pa", unit) for name, unit in ABSOLUTE.items()}
LETTERED = {"msec": "ms", "usec": "us", "mbar": "hPa", "lpm": "l/min", "l_min": "l/min", "c": "degC"}
LETTERED |= {"m_s": "m/s", "mps": "m/s", "mm_s": "mm/s", "m3": "m^3", "cm3": "cm^3"}
OTHERWISE = LETTERED | {  # spellings of loggers
    **dict.fromkeys(("sec", "secs", "second", "seconds", "sek"), "s"),
    **dict.fromkeys(("pct", "percent", "prozent"), "%"),
    **dict.fromkeys(("volt", "volts"), "V"),
    **dict.fromkeys(("m_s2", "m/s2"), "m/s^2"),
    **dict.fromkeys(("m3_s", "m3/s"), "m^3/s"),
    **dict.fromkeys(("°", "grad"), "deg"),
    **{f"{unit}_abs": f"{unit} abs" for unit in ("Pa", "kPa", "MPa", "bar")},
    **{f"{unit}a": f"{unit} abs" for unit in ("bar", "kPa", "MPa")},
    **{
        f"{unit}{mark}": unit for unit in ("bar", "kPa", "MPa") for mark in ("g", "_g", "(g)", " g", "_gauge", " gauge")
    },
}
EXTRA = {"hPa": ("Pa", Unit(1e2)), "psi": ("Pa", Unit(6894.757293168)), "in": ("m", Unit(0.0254))}  # NIST SP 811
EXTRA |= {"A": ("A", Unit(1.0)), "mA": ("A", Unit(1e-3)), "m/s^2": ("m/s^2", Unit(1.0)), "g0": ("m/s^2", Unit(9.80665))}
KNOWN = PLAIN | EXTRA
LOOSE = {"A", "g", "t", "h", "s", "m", "N", "K", "V", "l", "B", "c", "in", "T"}  # letters that names end in, too
BRACKETED = re.compile(r"^(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*)\))\s*$")
SAID = re.compile(r"^(.+?)(?:\s+in\s+|\s+/\s*|\s*,\s*)([^\s,]+(?: abs)?)$")
SPACED = re.compile(r"^(.+?)\s+(\S{2,}(?: abs)?)$")
SLASHED = re.compile(r"^([^/]+)/(\S{2,})$")
DASH = {"", "-", "--", "1", "–", "none", "n/a"}


def known_unit(text: str) -> str | None:
    """A unit in our spelling; "" for a dash or 1; None for what is not a unit that we know."""
    written = spelled(text.strip())
    if written.lower() in DASH:
        return ""
    for candidate in (written, OTHERWISE.get(written), OTHERWISE.get(written.lower())):
        if candidate in KNOWN:
            return candidate
    return None


def parted(head: str) -> tuple[str, str]:
    """Name and unit of a column's head; no unit where none is there that we know."""
    head = head.strip()
    for pattern in (BRACKETED, SAID, SPACED, SLASHED):
        if (match := pattern.match(head)) and match[1].strip():
            written = next(group for group in match.groups()[1:] if group is not None)
            if (unit := known_unit(written)) is not None:
                return match[1].strip(), unit
    return _by_ending(head)


def _by_ending(head: str) -> tuple[str, str]:
    """Of "position_mm", "p_A_Pa_abs", "velocity_m_s": the longest ending that is a unit; the name stays whole."""
    parts = head.split("_")
    for length in (3, 2, 1):
        ending = "_".join(parts[-length:])
        if (
            len(parts) > length
            and (unit := known_unit(ending))
            and not (length == 1 and ending in LOOSE - {"s", "V", "m"})
        ):
            return head, unit
    return head, ""


def factor(unit: str) -> tuple[str, Unit]:
    """The SI unit that a known unit counts in, and how it gets there."""
    return KNOWN[unit]
