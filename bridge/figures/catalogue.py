"""Every figure: its name, its title, and the function that draws it."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from bridge.drawing.canvas import Columns, Sheet
from bridge.drawing.files import save
from bridge.errors import UsageError, nearest
from bridge.figures.circuit import rig
from bridge.figures.friction import friction
from bridge.figures.lines import characteristics as lines_characteristics
from bridge.figures.lines import friction as lines_friction
from bridge.figures.lines import orders as lines_orders
from bridge.figures.lines import response as lines_response
from bridge.figures.oil import viscosity as oil
from bridge.figures.stability import causes as stability_causes
from bridge.figures.stability import charts as stability_charts
from bridge.figures.stability import edges as stability_edges
from bridge.figures.stability import limit_cycles, slow_manifold
from bridge.figures.transients import transients
from bridge.figures.valve import chatter as valve_chatter
from bridge.figures.valve import impact as valve_impact
from bridge.figures.valve import seat as valve_seat
from bridge.figures.valve import seats as valve_seats
from bridge.figures.valve import shear as valve_shear
from bridge.figures.valve import spectrum as valve_spectrum
from bridge.figures.valve import static as valve_static


class Figure(NamedTuple):
    """One figure."""

    name: str  # its number in the source; also the name of its files
    title: str
    draw: Callable[[], tuple[Columns, Sheet]]


_ALL = (
    Figure("2.2", "Viscosity of the oil over its temperature", oil.draw_viscosity),
    Figure("2.4", "Seal friction over the speed of the piston", friction.draw_over_speed),
    Figure("2.5", "Seal friction over the pressure difference", friction.draw_over_pressure),
    Figure("2.6", "Friction factor over the dimensionless speed", friction.draw_factor),
    Figure("2.14", "Discharge coefficient of orifice 2 over the Reynolds number", valve_static.draw_discharge),
    Figure("2.15", "Flow through orifice 2 over its pressure drop", valve_static.draw_orifice_flow),
    Figure("2.18", "Pressure force on the pilot", valve_static.draw_pilot_force),
    Figure("2.20", "Static curve of the relief valve, openings, knee", valve_static.draw_static),
    Figure("2.23", "Characteristics: whole steps and interpolated half steps", lines_characteristics.draw),
    Figure("2.25", "Schemes for waves, a smooth wave: error and work", lines_orders.draw_smooth),
    Figure("2.26", "Schemes for waves, steep fronts: error and work", lines_orders.draw_steep),
    Figure("2.27", "Friction models on a water hammer, beside the exact line", lines_friction.draw),
    Figure("2.28", "Load change and impingement at four pump speeds", transients.draw_experiment),
    Figure("2.29", "Load change: pressures, position, relief valve", transients.draw_load_change),
    Figure("2.30", "Impingement: pressures, position, relief valve", transients.draw_impingement),
    Figure("3.2", "Pressure along the conical seat", valve_seat.draw_pressure),
    Figure("3.3", "Flow through the conical seat over the lift", valve_seat.draw_exponent),
    Figure("3.4", "Flow through the conical seat over the pressure drop", valve_seat.draw_flow),
    Figure("3.8", "Pressure force on the cone", valve_seat.draw_force),
    Figure("3.9", "Parts of the pressure force on the cone", valve_seat.draw_components),
    Figure("3.10", "Viscous force on the cone: pressure term, exact over linear", valve_shear.draw_pressure_factor),
    Figure("3.11", "Viscous force on the cone: speed term, exact over linear", valve_shear.draw_speed_factor),
    Figure("3.13", "Velocity across the gap by two models", valve_shear.draw_profiles),
    Figure("3.14", "Difference of the two models", valve_shear.draw_difference),
    Figure("3.15", "Viscous force on the cone; damping by shear and film", valve_shear.draw_viscous),
    Figure("4.3", "Soft and hard loss of stability", valve_chatter.draw_loss),
    Figure("4.4", "Critical damping of both seats", valve_chatter.draw_critical),
    Figure("4.5", "Frequency of the swing that begins", valve_chatter.draw_frequency),
    Figure("5.3", "Pressures fall on the critical manifold, and what that leaves out", slow_manifold.draw_manifold),
    Figure("5.4", "Periodic orbits of the relay loop over its derivative gain", limit_cycles.draw_relay),
    Figure("5.5", "Periodic orbits of the proportional loop over its gain", limit_cycles.draw_proportional),
    Figure("5.7", "Closed curves of the sampled loop's stability, k = 0, d = 1", stability_charts.draw_curves),
    *(
        Figure(
            number,
            f"Stability chart of the sampled loop, k = {of.k:g}, d = {of.d:g}",
            partial(stability_charts.draw_chart, number),
        )
        for number, of in stability_charts.CHARTS.items()
    ),
    Figure("5.20", "Critical gain over the sampling interval, computed", stability_edges.draw_computed),
    Figure("5.21", "Critical gain over the sampling interval, found on the twin", stability_edges.draw_measured),
    Figure("areas", "Area of figures 5.8 to 5.19 by number of stable multipliers", stability_charts.draw_areas),
    Figure("causes", "Why the twin parts from its linear theory, by cause", stability_causes.draw_causes),
    Figure("line-response", "Impedance of a line: exact, and of each scheme", lines_response.draw),
    Figure("circuit", "The circuit, from the rig's own numbers", rig.draw_circuit),
    Figure("lyapunov", "First Lyapunov coefficient of both seats", valve_chatter.draw_lyapunov),
    Figure("equal-flow", "Both seats at equal flow, with the damping each has", valve_seats.draw_equal_flow),
    Figure("precompression", "Precompression raises the need for damping", valve_seats.draw_precompression),
    Figure("inlet-line", "A line before the valve: critical damping over its length", valve_seats.draw_inlet_line),
    Figure("impact", "Motion with impacts over the flow", valve_impact.draw_impact),
    Figure("impact-chart", "Calm, swinging or hitting over flow and damping", valve_impact.draw_chart),
    Figure("basin", "Hard loss of stability: which starts end calm", valve_impact.draw_basin),
    Figure("chatter-spectrum", "Acceleration of the relief valve's housing in the rig", valve_spectrum.draw_spectrum),
)


LONG = ("5.21", "causes")  # a minute on two cores: hundreds of runs of the twin


FIGURES: dict[str, Figure] = {figure.name: figure for figure in _ALL}


def draw_figure(name: str, directory: str | Path) -> tuple[Path, Path]:
    """Write NAME.png and NAME.csv into a directory, made if absent; returns both paths. UsageError: no such figure."""
    if name not in FIGURES:
        raise UsageError(f"no figure {name!r}{nearest(name, FIGURES)}")
    columns, sheet = FIGURES[name].draw()
    picture, table = save(name, columns, sheet, Path(directory))
    return picture, table
