"""The circuit in tables: its lines, their ends and taps, where oil can be hollow, and what a run observes.

Plain data without numba, for whoever lists, names or draws the circuit.
"""

LINES = 6

ENDS = ("pump", "tee_1", "tee_2", "p", "a", "lower", "b", "upper", "t", "back_5", "back_6", "tank")

OBSERVED = {  # name: SI unit
    "position": "m",
    "velocity": "m/s",
    "spool": "",
    **dict.fromkeys(("p_pump", "p1", "p_p", "p_a", "p_lower", "p_upper", "p_b", "p_t", "p_return"), "Pa"),
    **dict.fromkeys(("cavity_lower", "cavity_upper"), "m^3"),
    **dict.fromkeys((*(f"flow_{line}" for line in range(1, 7)), "flow_pump", "flow_relief"), "m^3/s"),
    **dict.fromkeys(("relief_pilot", "relief_spool"), "m"),
    "mass": "kg",
    "friction": "N",
    **dict.fromkeys(
        ("cavity_pump", "cavity_tee", "cavity_p", "cavity_a", "cavity_b", "cavity_t", "cavity_return", "cavity_lines"),
        "m^3",
    ),
    **dict.fromkeys(("oil_stored", "oil_pumped", "oil_relieved", "oil_returned"), "m^3"),
}

PLACES = 11  # along each line, from its first end (behind a fitting) to its second

HOLLOWS = (
    *("lower", "upper"),  # chambers
    *("pump", "tee", "p", "a", "b", "t", "return"),  # line ends, as CAVITIES of `block`
    *(f"line_{line}" for line in range(1, LINES + 1)),  # inside a line; only its model `nodes` has any
)

BALANCE_UNITS = {"force_balance": "Pa", "speed_balance": "m/s", "sink_balance": "m/s"}
