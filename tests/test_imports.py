"""Imports run downwards: each room stands on a level and knows only rooms below; no cycle within a level.

`python -m tests.test_imports` prints the levels that the code has.
"""

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
COMPONENTS = (
    *("air", "oil", "iso_vg", "orifice", "port", "contact", "fitting", "seal", "load", "pump", "cylinder", "lands"),
    *("spool_valve", "switching_valve", "directional_valve", "supply", "sensors", "amplifier", "minor_losses"),
    *("neck", "valve_body", "accessory", "counterbalance", "pilot_check", "throttle", "cushion", "necked_cylinder"),
    *("land_law", "land_network", "servo_opening", "servo_spool", "servo_valve"),
    *("lag", "fixed_pump", "variable_pump", "pressure_source", "accumulator", "check_valve", "return_end"),
    *(
        "stribeck",
        "lugre",
        "friction",
        "table",
        "environment",
        "compliant",
        "lever",
        "load_slot",
        "motor",
        "actuator",
        "load_at_rest",
    ),
)
LEVELS: dict[str, tuple[tuple[str, ...], ...]] = {  # from the bottom up; a file without a folder is a room too
    "twin": (
        ("quantity",),
        ("rig_accessories", "rig_mechanics", "rig_servo"),
        ("topology", "rig", "integration", "cache_folder", "sealed_files"),
        ("compiled_code", "native_code", "kept"),
        ("compiler",),
        ("kernel",),
        COMPONENTS,
        ("seats", "lines"),
        ("relief",),
        ("circuit",),
        ("chatter", "estimation"),
    ),
    "controller": (
        (
            *("bands", "course", "grid", "hold", "law", "laws", "linear_system", "metrics", "oscillation"),
            *("pid", "reference", "state_space", "stretches", "tracking", "window"),
        ),
        ("stability",),
        ("stability.actuator", "stability.amplitude"),
        ("stability.orbits",),
    ),
    "bridge": (
        ("errors",),
        ("drawing",),
        ("wire",),
        ("scenario", "machine"),
        ("loop", "recording"),
        ("processes", "view", "studies", "connect"),
        ("runs", "replay", "figures"),
        ("report", "panel"),
        ("cli",),
        ("__main__",),
    ),
    "hydrotwin": (
        ("signal",),
        ("runs",),
        ("policy",),
        ("sweeps", "pytest_plugin", "gym"),
    ),
}
ORDER = ("twin", "controller", "bridge", "hydrotwin")  # of the packages: each may use those before it
SHARED = {COMPONENTS, LEVELS["controller"][0]}  # levels whose rooms may know one another
MOST_FILES = 4  # at the top of `bridge`
LAWS = LEVELS["controller"][0]
IMPURE = {"time", "socket", "subprocess", "zenoh", "mcap", "rich", "typer", "threading", "datetime", "random"}
Edges = dict[str, set[str]]  # room: those it imports


@cache
def imported(path: Path) -> frozenset[str]:
    """Every module that a file imports, anywhere in it, and every name that may be a module of one."""
    return frozenset(_imported(path))


def _imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            yield node.module or ""
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def room_of(module: str, package: str) -> str | None:
    """The room of a module: the longest name in the table that it begins with; None for the package itself."""
    below = module.removeprefix(f"{package}.")
    rooms = [room for level in LEVELS[package] for room in level]
    found = [room for room in rooms if below == room or below.startswith(f"{room}.")]
    return max(found, key=len, default=None) if module.startswith(f"{package}.") else None


def edges(package: str) -> Edges:
    """Which room imports which; a file that belongs to none is a mistake."""
    found: Edges = {}
    for path in sorted((ROOT / package).rglob("*.py")):
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        room = room_of(module, package)
        assert room or module == package, f"{module} belongs to no room of {package}: give it one in LEVELS"
        wanted = {other for name in imported(path) if (other := room_of(name, package))}
        found.setdefault(room or package, set()).update(wanted - {room})
    return found


@pytest.mark.parametrize("package", ORDER)
def test_every_room_imports_only_what_is_below_it(package: str):
    height = {room: number for number, level in enumerate(LEVELS[package]) for room in level}
    shared = {room for level in LEVELS[package] if level in SHARED for room in level}
    up = [
        f"{package}.{room} imports {package}.{other}"
        for room, others in edges(package).items()
        for other in others
        if room != package and height[other] >= height[room] and not {room, other} <= shared
    ]
    assert not up


@pytest.mark.parametrize("package", ORDER)
def test_no_room_needs_itself(package: str):
    try:
        TopologicalSorter(edges(package)).prepare()
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))


@pytest.mark.parametrize("package", ORDER)
def test_packages_stand_on_one_another(package: str):
    for path in (ROOT / package).rglob("*.py"):
        inner = {name.split(".")[0] for name in imported(path)} & set(ORDER)
        above = inner - set(ORDER[: ORDER.index(package) + 1])
        assert not above, f"{path.relative_to(ROOT)} imports {above}"


def top_files() -> list[str]:
    """The files of `bridge` that stand in no room."""
    return sorted(path.name for path in (ROOT / "bridge").glob("*.py"))


def test_few_files_stand_outside_the_rooms():
    assert len(top_files()) <= MOST_FILES, top_files()


@pytest.mark.parametrize("package", ["twin", "controller"])
def test_the_core_knows_no_clock_network_or_screen(package: str):
    for path in (ROOT / package).rglob("*.py"):
        found = {name.split(".")[0] for name in imported(path)} & IMPURE
        assert not found, f"{path.relative_to(ROOT)} imports {found}"


@pytest.mark.parametrize("name", LAWS)
def test_control_laws_need_nothing_of_the_plant(name: str):
    assert not any(module.startswith("twin") for module in imported(ROOT / "controller" / f"{name}.py"))


def heights(found: Edges) -> dict[str, int]:
    """How many rooms lie below each, one on another."""
    height: dict[str, int] = {}
    for room in TopologicalSorter(found).static_order():
        height[room] = 1 + max((height[other] for other in found.get(room, ())), default=0)
    return height


def show() -> None:
    """Print the levels that the imports make, lowest first."""
    for package in ORDER:
        height = heights({room: others for room, others in edges(package).items() if room != package})
        print(f"{package}: {max(height.values())} levels")
        for level in range(1, max(height.values()) + 1):
            print(f"  {level}  {' '.join(sorted(room for room, at in height.items() if at == level))}")
    print(f"files at the top of bridge: {len(top_files())} ({', '.join(top_files())})")


if __name__ == "__main__":
    show()
