"""All verbs in the order in which help shows them: where each is found, and its line of the help.

A verb's module is imported when the verb is asked for, so that no command pays for the others.
"""

from typing import NamedTuple

RUN, LOOK, PROCESSES = "Run", "Look", "Processes"  # panels of the help


class Verb(NamedTuple):
    """A verb of the command line."""

    panel: str
    place: str  # module in `bridge.cli`, and the function there, or the application of a group
    words: str  # the first paragraph of its own help


VERBS = {
    "run": Verb(RUN, "run:run", "Run a scenario and leave a recording, a picture and a summary."),
    "check": Verb(RUN, "run:check", "Run scenarios headless and judge the bands they state; for CI."),
    "sweep": Verb(
        RUN, "sweep:sweep", "Run a scenario at every combination of some of its values: a table, CSV and a picture."
    ),
    "tune": Verb(RUN, "tune:tune", "Find the values of a scenario that make a metric smallest, within bands."),
    "identify": Verb(
        RUN,
        "identify:identify",
        "Fit numbers of a rig to recordings: the recorded commands through the twin, measured signals compared.",
    ),
    "campaign": Verb(
        RUN,
        "campaign:campaign",
        "Run a matrix of scenarios, faults, parameters and seeds, and judge every run by its bands.",
    ),
    "scenarios": Verb(LOOK, "scenarios:scenarios", "List the built-in scenarios."),
    "schema": Verb(LOOK, "scenarios:schema", "Print the JSON schema of scenario files, for editors."),
    "describe": Verb(
        LOOK,
        "scenarios:describe",
        "Print a scenario's circuit: parts, values with their sources, frequencies, travel times, limits of the step.",
    ),
    "faults": Verb(LOOK, "faults:faults", "List what can go wrong: targets, kinds, and the numbers of each."),
    "convergence": Verb(
        LOOK,
        "scenarios:convergence",
        "Run a scenario at its step, a half and a quarter of it: error and order of each signal.",
    ),
    "advise": Verb(
        LOOK,
        "stability:advise",
        "Find the gains at which a scenario's loop settles, swings after every motion, or depends on the motion.",
    ),
    "map": Verb(
        LOOK,
        "stability:map_stability",
        "Draw a chart of stability over two numbers of the loop: OUTPUT.png, .csv, .html, and the runs' own .csv.",
    ),
    "linearise": Verb(
        LOOK,
        "linear:linearise",
        "Write the linear model of a scenario's rig: A, B, C, D, names and units, continuous and as its loop samples "
        "it.",
    ),
    "dimensionless": Verb(
        LOOK,
        "dimensionless:dimensionless",
        "Convert a scenario's drive and controller to the thesis's alpha, gamma, k, tau, s and d, and back (--at).",
    ),
    "view": Verb(
        LOOK,
        "looking:view",
        "Show a recording, or without FILE a running plant, in Rerun: the rig in 3-D, curves, maps of the pipes, "
        "events.",
    ),
    "panel": Verb(
        LOOK,
        "panel:panel",
        "Watch and operate a rig from a page in the browser: live circuit, curves, numbers, faults, safety, health.",
    ),
    "report": Verb(
        LOOK,
        "looking:report",
        "Write one page on a run, to read offline and on paper; of several runs an overlay and their differences.",
    ),
    "info": Verb(
        LOOK,
        "recordings:info",
        "Say what a recording holds and how its run went: channels, rates, gaps, events, metrics.",
    ),
    "compare": Verb(
        LOOK,
        "recordings:compare",
        "Compare two recordings signal by signal: greatest difference, rms, where it begins. Exit code 1: they differ.",
    ),
    "recover": Verb(
        LOOK,
        "recordings:recover",
        "Recover the readable part of a truncated or damaged recording, or join the parts of one run.",
    ),
    "export": Verb(LOOK, "recordings:export", "Write a recording for other programs, units in the headers."),
    "import": Verb(
        LOOK,
        "importing:import_log",
        "Import a log that another program has measured on a rig: a recording that every verb takes.",
    ),
    "digest": Verb(
        LOOK, "recordings:digest", "Print one hash per data channel; with several files, say whether they are the same."
    ),
    "fmu": Verb(
        LOOK,
        "fmu:app",
        "Write a scenario's plant or controller as an FMU, compiled, for Simulink and other tools: docs/fmu.md.",
    ),
    "messages": Verb(
        LOOK,
        "machine:messages",
        "Print every key, type, rate, `.msg` text and `struct` format, and how to write a controller with them.",
    ),
    "figures": Verb(LOOK, "figures:figures", "List the figures, or draw them all."),
    "figure": Verb(LOOK, "figures:figure", "Draw a figure of the thesis from the twin: NAME.png and NAME.csv."),
    "line": Verb(
        LOOK,
        "line:line",
        "Simulate waves in one pipe with any scheme, compared with the exact line: line.png, line.csv and a summary.",
    ),
    "doctor": Verb(LOOK, "machine:doctor", "Look at this machine: can it run the loop, and how punctually?"),
    "plant": Verb(PROCESSES, "processes:plant", "Simulate the rig: publish measurements, take valve commands."),
    "controller": Verb(
        PROCESSES, "processes:controller", "Answer measurements with valve commands until the plant ends."
    ),
    "record": Verb(
        PROCESSES, "record:record", "Record everything on a rig's keys to an MCAP file until the plant ends."
    ),
    "replay": Verb(
        PROCESSES,
        "replay:replay",
        "Play a recording on the bus with its own timing; or --into the twin or a controller, and judge what "
        "comes out.",
    ),
    "follow": Verb(
        PROCESSES,
        "follow:follow",
        "Estimate what no sensor reads: twins beside a rig or a recording, corrected by its measurements.",
    ),
    "whatif": Verb(
        PROCESSES,
        "follow:whatif",
        "Say what would happen if a number of the controller were changed now, from the present estimate.",
    ),
    "remote": Verb(
        PROCESSES, "replay:remote", "Control a replay that runs, from anywhere: prints where it stands then."
    ),
    "foxglove": Verb(
        PROCESSES,
        "connecting:foxglove",
        "Serve a rig that runs, or a replay, to Foxglove: every topic, numbers that can change, services, the play "
        "bar.",
    ),
    "ros": Verb(
        PROCESSES,
        "connecting:ros",
        "Show a rig that runs, or a replay, to nodes of ROS 2 with rmw_zenoh, and take commands and settings from "
        "them.",
    ),
    "router": Verb(
        PROCESSES, "processes:router", "Route between machines until interrupted; plants and clients use --connect."
    ),
    "keys": Verb(
        PROCESSES,
        "keys:keys",
        "Make certificates, passwords and Zenoh configurations for a network on which each role may do only its part.",
    ),
    "reset": Verb(PROCESSES, "processes:reset", "Bring a plant out of its safe state."),
    "get": Verb(
        PROCESSES, "tuning:get", "Print numbers that can change while a rig runs: their values now, units and limits."
    ),
    "set": Verb(
        PROCESSES,
        "tuning:set_",
        "Change numbers of a rig that runs, all of them or none; the recording keeps each change with its instant.",
    ),
    "fault": Verb(
        PROCESSES,
        "faults:fault",
        "Inject a fault into a rig that runs, or end one; the recording keeps both, and a replay repeats them.",
    ),
    "status": Verb(
        PROCESSES,
        "status:status",
        "Say who is at a rig that runs and how each is doing: plant, controller, recorder, follower.",
    ),
    "watch": Verb(
        PROCESSES,
        "tuning:watch",
        "Show position, reference, pressures and valve of a rig that runs, and numbers that can change, until it ends.",
    ),
    "valve": Verb(LOOK, "valve:app", "Static curves, seats and chatter of relief valves: docs/valves.md."),
}
