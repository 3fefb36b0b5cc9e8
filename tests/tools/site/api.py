"""Pages on the Python packages, made from their docstrings: what users' programs import, and what they may read."""

from typing import NamedTuple

FOLDER = "reference"


class Page(NamedTuple):
    """A page of the reference."""

    title: str
    words: str
    modules: tuple[str, ...]


PAGES = {
    "hydrotwin": Page(
        "hydrotwin",
        "What programs and tests import. These names stay as they are from one minor version to the next; "
        "[Runs from Python](../python.md) shows them at work.",
        ("hydrotwin",),
    ),
    "hydrotwin-gym": Page(
        "hydrotwin.gym",
        "The rig as an environment of Gymnasium, a trained policy as a control law, and the fixture of pytest. "
        "[The guide](../gymnasium.md) trains one.",
        ("hydrotwin.gym", "hydrotwin.gym.rig", "hydrotwin.policy", "hydrotwin.pytest_plugin"),
    ),
    "controller": Page(
        "controller: laws and the loop",
        "Control laws, the time grid, the hold and references. These modules may move between versions.",
        tuple(f"controller.{m}" for m in ("law", "laws", "pid", "state_space", "grid", "hold", "reference")),
    ),
    "controller-metrics": Page(
        "controller: metrics and bands",
        "How a run is measured and judged; [Metrics](../metrics.md) defines each. These modules may move between "
        "versions.",
        tuple(f"controller.{m}" for m in ("metrics", "bands", "window", "oscillation", "tracking")),
    ),
    "controller-stability": Page(
        "controller: stability",
        "Linear theory of the sampled loop; [Stability](../stability.md) is its guide. These modules may move between "
        "versions.",
        ("controller.stability",),
    ),
    "twin": Page(
        "twin: the circuit",
        "The rig's tables and numbers, and the circuit made of them. These modules may move between versions.",
        (
            *("twin.topology", "twin.circuit.build", "twin.circuit.step", "twin.circuit.block", "twin.circuit.state"),
            *("twin.circuit.equilibrium", "twin.circuit.linear", "twin.sensors"),
        ),
    ),
    "twin-components": Page(
        "twin: components",
        "One file each: where it comes from, its parameters, its equations. [The plant](../theory/plant.md) has the "
        "symbols. These modules may move between versions.",
        tuple(
            f"twin.{m}"
            for m in ("cylinder", "seal", "load", "contact", "pump", "orifice", "spool_valve", "oil", "port")
        ),
    ),
}


def api_pages() -> dict[str, str]:
    """Path in the site to a page on which mkdocstrings puts the docstrings."""
    return {f"{FOLDER}/{name}.md": _page(page) for name, page in PAGES.items()}


def _page(page: Page) -> str:
    modules = [f"::: {module}" for module in page.modules]
    return "\n\n".join([f"# {page.title}", page.words, *modules]) + "\n"
