"""Every figure: its name, its title, and the function that draws it, imported when it is asked for."""

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from bridge.errors import UsageError, nearest, writing
from bridge.figures.stability.damped import CHARTS

if TYPE_CHECKING:
    from bridge.drawing.canvas import Columns, Sheet


class Figure(NamedTuple):
    """One figure."""

    name: str  # its number in the thesis; also the name of its files
    title: str
    source: str  # folder, file and function below this package
    of: str | None = None  # which of several that one function draws
    is_kept: bool = False  # what has been computed, in a file, while it is not finished

    def draw(self, part: Path | None = None) -> "tuple[Columns, Sheet]":
        """The table and the sheet; part: file of what an interrupted drawing had computed."""
        module, _, function = self.source.rpartition(".")
        drawing = getattr(import_module(f"bridge.figures.{module}"), function)
        if self.is_kept:
            return drawing(part)
        return drawing() if self.of is None else drawing(self.of)


_ALL = (
    Figure("2.2", "Viscosity of the oil over its temperature", "oil.viscosity.draw_viscosity"),
    Figure("2.4", "Seal friction over the speed of the piston", "friction.friction.draw_over_speed"),
    Figure("2.5", "Seal friction over the pressure difference", "friction.friction.draw_over_pressure"),
    Figure("2.6", "Friction factor over the dimensionless speed", "friction.friction.draw_factor"),
    Figure("2.14", "Discharge coefficient of orifice 2 over the Reynolds number", "valve.static.draw_discharge"),
    Figure("2.15", "Flow through orifice 2 over its pressure drop", "valve.static.draw_orifice_flow"),
    Figure("2.18", "Pressure force on the pilot", "valve.static.draw_pilot_force"),
    Figure("2.20", "Static curve of the relief valve, openings, knee", "valve.static.draw_static"),
    Figure("2.23", "Characteristics: whole steps and interpolated half steps", "lines.characteristics.draw"),
    Figure("2.25", "Schemes for waves, a smooth wave: error and work", "lines.orders.draw_smooth"),
    Figure("2.26", "Schemes for waves, steep fronts: error and work", "lines.orders.draw_steep"),
    Figure("2.27", "Friction models on a water hammer, compared with the exact line", "lines.friction.draw"),
    Figure("2.28", "Load change and impingement at four pump speeds", "transients.transients.draw_experiment"),
    Figure("2.29", "Load change: pressures, position, relief valve", "transients.transients.draw_load_change"),
    Figure("2.30", "Impingement: pressures, position, relief valve", "transients.transients.draw_impingement"),
    Figure("3.2", "Pressure along the conical seat", "valve.seat.draw_pressure"),
    Figure("3.3", "Flow through the conical seat over the lift", "valve.seat.draw_exponent"),
    Figure("3.4", "Flow through the conical seat over the pressure drop", "valve.seat.draw_flow"),
    Figure("3.8", "Pressure force on the cone", "valve.seat.draw_force"),
    Figure("3.9", "Parts of the pressure force on the cone", "valve.seat.draw_components"),
    Figure("3.10", "Viscous force on the cone: pressure term, exact over linear", "valve.shear.draw_pressure_factor"),
    Figure("3.11", "Viscous force on the cone: speed term, exact over linear", "valve.shear.draw_speed_factor"),
    Figure("3.13", "Velocity across the gap by two models", "valve.shear.draw_profiles"),
    Figure("3.14", "Difference of the two models", "valve.shear.draw_difference"),
    Figure("3.15", "Viscous force on the cone; damping by shear and film", "valve.shear.draw_viscous"),
    Figure("4.3", "Soft and hard loss of stability", "valve.chatter.draw_loss"),
    Figure("4.4", "Critical damping of both seats", "valve.chatter.draw_critical"),
    Figure("4.5", "Frequency of the swing that begins", "valve.chatter.draw_frequency"),
    Figure(
        "5.3",
        "Pressures fall on the critical manifold, and what that leaves out",
        "stability.slow_manifold.draw_manifold",
    ),
    Figure("5.4", "Periodic orbits of the relay loop over its derivative gain", "stability.limit_cycles.draw_relay"),
    Figure("5.5", "Periodic orbits of the proportional loop over its gain", "stability.limit_cycles.draw_proportional"),
    Figure("5.7", "Closed curves of the sampled loop's stability, k = 0, d = 1", "stability.charts.draw_curves"),
    *(
        Figure(
            name,
            f"Stability chart of the sampled loop, k = {of.k:g}, d = {of.d:g}",
            "stability.charts.draw_chart",
            name,
        )
        for name, of in CHARTS.items()
    ),
    Figure("5.20", "Critical gain over the sampling interval, computed", "stability.edges.draw_computed"),
    Figure(
        "5.21",
        "Critical gain over the sampling interval, found on the twin",
        "stability.edges.draw_measured",
        is_kept=True,
    ),
    Figure("areas", "Area of figures 5.8 to 5.19 by number of stable multipliers", "stability.charts.draw_areas"),
    Figure(
        "causes", "Why the twin and its linear theory disagree, by cause", "stability.causes.draw_causes", is_kept=True
    ),
    Figure(
        "relay", "The relay's cycle on the rig, predicted and found on the twin", "stability.relay_loop.draw_relay_loop"
    ),
    Figure("density", "Density of the oil by 13 weighings", "oil.density.draw_density"),
    Figure("bulk-modulus", "Bulk modulus of the oil by the wave speed", "oil.bulk_modulus.draw_bulk_modulus"),
    Figure("pilot-loss", "Table 2.2: loss coefficient of the pilot, CFD, (2.26), Idelchik", "valve.loss.draw_loss"),
    Figure("viscous-models", "Viscous force on the cone by three models", "valve.viscous.draw_models"),
    Figure("rig-friction", "Unsteady and quasi-steady friction in the rig", "transients.friction.draw"),
    Figure("coupled-line", "A line of variable steps together with the cylinder", "lines.coupled.draw"),
    Figure("line-response", "Impedance of a line: exact, and of each scheme", "lines.response.draw"),
    Figure("circuit", "The circuit, from the rig's own numbers", "circuit.rig.draw_circuit"),
    Figure("lyapunov", "First Lyapunov coefficient of both seats", "valve.chatter.draw_lyapunov"),
    Figure("equal-flow", "Both seats at equal flow, with the damping each has", "valve.seats.draw_equal_flow"),
    Figure("precompression", "Precompression raises the need for damping", "valve.seats.draw_precompression"),
    Figure("inlet-line", "A line before the valve: critical damping over its length", "valve.seats.draw_inlet_line"),
    Figure("impact", "Motion with impacts over the flow", "valve.impact.draw_impact"),
    Figure("impact-chart", "Calm, swinging or hitting over flow and damping", "valve.impact.draw_chart"),
    Figure("basin", "Hard loss of stability: which starts end calm", "valve.impact.draw_basin"),
    Figure("chatter-spectrum", "Acceleration of the relief valve's housing in the rig", "valve.spectrum.draw_spectrum"),
)


LONG = ("5.21", "causes", "relay")  # a minute on two cores and more: hundreds of runs of the twin


MARKABLE = ("5.7", *CHARTS)
FIGURES: dict[str, Figure] = {figure.name: figure for figure in _ALL}


def draw_figure(name: str, directory: str | Path, mark: str | None = None) -> tuple[Path, Path]:
    """Write NAME.png and NAME.csv into a directory, made if absent; returns both paths. UsageError: no such figure.

    One of many runs of the twin keeps them in NAME.part meanwhile, and continues there after an interruption.
    mark: a scenario whose rig is marked on a stability chart.
    """
    if name not in FIGURES:
        raise UsageError(f"no figure {name!r}{nearest(name, FIGURES)}")
    from bridge.drawing.files import save

    if mark is not None and name not in MARKABLE:
        raise UsageError(f"--mark {mark}: figure {name} is not a dimensionless chart; those are {', '.join(MARKABLE)}")
    figure = FIGURES[name]
    if figure.is_kept:
        with writing(Path(directory)):
            Path(directory).mkdir(parents=True, exist_ok=True)
    columns, sheet = figure.draw(Path(directory) / f"{name}.part")
    if mark is not None:
        from bridge.figures.stability.charts import add_mark

        add_mark(sheet, name, mark)
    picture, table = save(name, columns, sheet, Path(directory))
    return picture, table
