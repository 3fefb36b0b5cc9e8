"""The circuit of a drive in characters: what is fitted, between the same six lines.

A line's number is its name: --3--> a pipe, --[3]--> a volume without inertia, --(3)--> a manifold instead of a pipe.
"""

from bridge.scenario.fitted import (
    Values,
    chamber_names,
    chamber_words,
    has_relief_line,
    is_motor,
    kind_of,
    orientation,
    rod_words,
    word,
)

SUPPLY = {"gear": "gear pump", "fixed": "fixed pump", "variable": "variable pump", "pressure": "pressure source"}
RELIEF = {"two-stage": "two-stage relief > tank", "direct": "direct relief > tank"}
VALVE_BODY = {"proportional": "proportional", "switching": "switching", "servo": "servo"}
LOAD = {"mass": "load", "environment": "load in springs", "compliant": "two masses", "lever": "lever"}
ROW_UP, ROW_TOP, ROW_A, ROW_MIDDLE, ROW_B, ROW_BOTTOM, ROW_RETURN = range(7)
AROUND = 3  # columns between port and box


class Sheet:
    """Characters by row and column."""

    def __init__(self) -> None:
        self._rows: list[str] = []

    def put(self, row: int, column: int, text: str) -> int:
        """Write a text; returns the column behind it."""
        self._rows += [""] * (row + 1 - len(self._rows))
        line = self._rows[row].ljust(column)
        self._rows[row] = line[:column] + text + line[column + len(text) :]
        return column + len(text)

    def __str__(self) -> str:
        return "\n".join(line.rstrip() for line in self._rows) + "\n"


def text_picture(values: Values) -> str:
    """The whole picture."""
    sheet = Sheet()
    left = f"  tank > {SUPPLY[kind_of(values, 'supply')]} {_line(values, 1)}> "
    tee = len(left) + 1
    p = sheet.put(ROW_A, 0, f"{left}tee {_fittings(values)}{_line(values, 2)}> ")
    _branches(sheet, values, tee, p)
    box = sheet.put(ROW_A, p, "P -")
    _cylinder_side(sheet, values, _valve(sheet, values, box))
    _return(sheet, values, p)
    return str(sheet)


def _line(values: Values, number: int) -> str:
    model = values[f"pipe_{number}"]["model"]
    return f"--{ {'volume': f'[{number}]', 'none': f'({number})'}.get(model, number) }--"


def _fittings(values: Values) -> str:
    names = [("filter", values["filter"]["drop"] > 0.0), ("check", kind_of(values, "check valve") != "none")]
    return "".join(f"--{name}" for name, there in names if there)


def _branches(sheet: Sheet, values: Values, tee: int, p: int) -> None:
    """What hangs on the tee and on port P."""
    accumulator = kind_of(values, "accumulator") != "none"
    at_tee = accumulator and word(values, "accumulator.at") != "p"
    sheet.put(ROW_UP, tee, "p1, accumulator" if at_tee else "p1")
    sheet.put(ROW_TOP, tee, "|")
    if accumulator and not at_tee:
        sheet.put(ROW_UP, p - len("accumulator") + 1, "accumulator")
        sheet.put(ROW_TOP, p, "|")
    kind = kind_of(values, "relief valve")
    if kind != "none":
        sheet.put(ROW_MIDDLE, tee, "7" if has_relief_line(values) else "|")
        sheet.put(ROW_B, tee - RELIEF[kind].index("relief") - 2, RELIEF[kind])


def _valve(sheet: Sheet, values: Values, column: int) -> int:
    """The box; returns the column behind it."""
    name = VALVE_BODY[kind_of(values, "directional valve")]
    width = len(name) + 2
    for row in (ROW_TOP, ROW_BOTTOM):
        sheet.put(row, column, f"+{'-' * width}+")
    for row, words in ((ROW_A, name), (ROW_MIDDLE, "valve"), (ROW_B, "")):
        sheet.put(row, column, f"|{words.center(width)}|")
    return column + width + 2


def _cylinder_side(sheet: Sheet, values: Values, column: int) -> None:
    """Lines 3 and 4, accessories, chambers with their taps; the actuator and its load between them."""
    ports = ((ROW_A, "A", 3, "accessory at A", "lower", "p2"), (ROW_B, "B", 4, "accessory at B", "upper", "p3"))
    ways = [f"- {port} {_line(values, line)}{_accessory(values, slot)}>" for _, port, line, slot, *_ in ports]
    wide = max(map(len, ways))
    names, sides = chamber_names(values), chamber_words(values)
    chambers = [f"{names[chamber]} ({sides[chamber]})" for *_, chamber, _ in ports]
    reach = max(map(len, chambers))
    for (row, *_, tap), way, chamber in zip(ports, ways, chambers, strict=True):
        at = sheet.put(row, column, f"{way[:-1].ljust(wide - 1, '-')}>  {_cushion(values)}")
        sheet.put(row, at, f"{chamber.ljust(reach)} -- {tap}")
    sheet.put(ROW_MIDDLE, column + wide + 2 + len(_cushion(values)), _moving(values))


def _accessory(values: Values, slot: str) -> str:
    kind = kind_of(values, slot)
    return "" if kind == "none" else f"{kind}--"


def _cushion(values: Values) -> str:
    return "" if kind_of(values, "cushions") == "none" or is_motor(values) else "~ "


def _moving(values: Values) -> str:
    load = LOAD[kind_of(values, "load")]
    if is_motor(values):
        return f"  motor: {orientation(values)}; {load}"
    return f"  piston; {rod_words(values)}, {load} on the rod"


def _return(sheet: Sheet, values: Values, p: int) -> None:
    end = {"orifice": "orifice ", "check": "orifice, check "}.get(kind_of(values, "return end"), "")
    at = sheet.put(
        ROW_RETURN, 0, f"  tank {f'<-- {end}' if end else ''}<{_line(values, 6)} return tee <{_line(values, 5)}"
    )
    sheet.put(ROW_RETURN, at, f"{'-' * max(0, p - at - 1)} T --'")
