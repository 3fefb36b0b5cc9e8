"""All verbs, registered with the application in the order in which help shows them."""

from bridge.cli import (
    figures,
    line,
    looking,
    machine,
    processes,
    record,
    recordings,
    replay,
    run,
    scenarios,
    stability,
    valve,
)
from bridge.cli.app import LOOK, PROCESSES, RUN, app

PANELS = {
    RUN: (run.run, run.check),
    LOOK: (
        scenarios.scenarios,
        scenarios.schema,
        scenarios.describe,
        scenarios.convergence,
        stability.advise,
        stability.map_stability,
        looking.view,
        looking.report,
        recordings.info,
        recordings.compare,
        recordings.recover,
        recordings.export,
        recordings.digest,
        machine.messages,
        figures.figures,
        figures.figure,
        line.line,
        machine.doctor,
    ),
    PROCESSES: (
        processes.plant,
        processes.controller,
        record.record,
        replay.replay,
        replay.remote,
        processes.router,
        processes.reset,
    ),
}
NAMES = {"map_stability": "map"}  # where a verb is a word that Python has taken
for _panel, _verbs in PANELS.items():
    for _verb in _verbs:
        app.command(NAMES.get(_verb.__name__), rich_help_panel=_panel)(_verb)
app.add_typer(valve.app, name="valve", rich_help_panel=LOOK)
