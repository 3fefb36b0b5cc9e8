"""What each message holds: its definition in the language of ROS 2, from the tables of what the twin has."""

from twin.topology import CHAMBERS, CHANNELS, HOLLOWS, LINES, OBSERVED, POINTS, PORTS

MEASURED = {name: f"[{channel.unit}]{channel.note}" for name, channel in CHANNELS.items()}
COMPARABLE = {name: f"[{channel.unit}]" for name, channel in CHANNELS.items()}


def floats(comments: dict[str, str]) -> str:
    """Lines of a message definition, their comments one below the other."""
    width = max(map(len, comments))
    return "".join(f"float64 {name:{width}}  # {comment}\n" for name, comment in comments.items())


LOOP_MESSAGES: dict[str, str] = {
    "Measurement": """\
# One scan of the data acquisition: what the card read.
uint64 run_id
uint64 sequence
uint64 tick       # stamp = tick * DAQ period
int64 stamp       # simulated time since the start of the run [ns]
"""
    + floats(MEASURED),
    "ValveCommand": """\
# One command to the proportional valve, held until the next one acts.
uint64 run_id
uint64 source        # random, one per controller: the first valid one owns the plant
uint64 sequence      # counts this controller's commands
int64 sample_stamp   # stamp of the measurement it answers [ns]
int64 apply_at       # when it acts [ns], a whole number of internal steps
float64 spool        # spool reference, -1 .. 1; positive lifts
""",
    "Reference": """\
# What the controller wanted at a sample.
uint64 run_id
uint64 source
uint64 sequence
int64 stamp       # [ns]
float64 position  # [m]; NaN for a law that follows none
float64 velocity  # [m/s]
""",
    "PlantState": "# The true state, unseen by the card.\nuint64 run_id\nuint64 sequence\nuint64 tick\nint64 stamp\n"
    + "float64 reference  # spool reference in force, -1 .. 1\n"
    + "".join(f"float64 {name}  # [{unit or 'share'}]\n" for name, unit in OBSERVED.items()),
    "LoopTiming": """\
# One tick in real time: wall-clock things, never part of the data.
uint64 run_id
uint64 sequence
uint64 tick
int64 stamp       # [ns] simulated
int64 lateness    # of the wake-up [ns] wall
int64 cost        # of integrating, sampling and publishing the measurement [ns] wall
int64 round_trip  # measurement out to its command in [ns] wall; -1 without a new one
int64 slack       # how long before it was needed the last command came [ns] wall; negative: late; 0 without one
""",
    "Residual": """\
# What came out of a replay, less what was recorded; NaN where there is nothing to compare.
uint64 run_id     # of the recorded run
uint64 sequence
int64 stamp       # [ns] of the measurement, of a command the sample it answers
"""
    + floats(COMPARABLE | {"position": "[m], of measurements", "spool": "spool reference, of commands"}),
}

OTHER_MESSAGES: dict[str, str] = {
    "Channels": """\
# Further channels of the card, sampled at the stamp of the measurement with the same sequence.
# Then a float64 for each of the scenario's daq.channels, in their order.
# `hydrotwin messages --scenario X` prints the whole.
uint64 run_id
uint64 sequence
uint64 tick
int64 stamp       # [ns]
""",
    "Event": """\
# Something worth knowing about a run.
uint64 run_id
uint64 sequence
int64 stamp       # simulated [ns]
string kind       # started, ended, late, missed, refused, changed, fault, differs; of a controller: said;
                  # of the plant's safety: safe, latched, degraded, restored, alarm, cleared, reset, resumed
uint64 source     # of the command it is about, or of the controller that speaks, else 0
uint64 command    # its sequence; or the number of the timeline's entry, of the alarm; else 0
int64 apply_at    # when the command was to act [ns], else 0
int64 applied_at  # when it acted [ns], else 0
string text
""",
    "Signals": """\
# Numbers that a law logs at a sample, under names of its own: the same in every message of a run.
uint64 run_id
uint64 source
uint64 sequence
int64 stamp       # of the measurement it answers [ns]
string[] names    # letters, digits and _
string[] units    # SI; of a number without one, empty
float64[] values
""",
    "LineProfile": f"""\
# Pressure along the six lines, and where there is a cavity.
uint64 run_id
uint64 sequence
uint64 tick
int64 stamp          # simulated [ns]
uint64 places        # in a line ({POINTS}), evenly spaced from its first end, behind a fitting, to its second
float64[] pressure   # [Pa] gauge, line after line, in each place after place: that of line i at place j, from 0,
                     # is pressure[i * places + j]
float64[] cavity     # [m^3] of vapour, in this order: {", ".join(CHAMBERS)} (chambers);
                     # {", ".join(PORTS)} (line ends); {HOLLOWS[-LINES]} .. {HOLLOWS[-1]} (inside)
""",
    "Status": """\
# How a process is doing.
uint64 run_id
uint64 sequence
int64 stamp       # simulated [ns]
string role       # plant, controller, recorder
string phase      # running, degraded, safe, latched; at the end: ended, interrupted, failed
uint64 pid
string[] names    # of the values
float64[] values
string text       # what else there is to say; of a failure the reason
""",
}

STANDARD_MESSAGES: dict[str, str] = {  # of ROS 2, for its tools
    "builtin_interfaces/msg/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/msg/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "std_msgs/msg/Empty": "",
    "sensor_msgs/msg/JointState": """\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
""",
    "sensor_msgs/msg/FluidPressure": "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n",
}
