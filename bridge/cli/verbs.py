"""All verbs, registered with the application in the order in which help shows them."""

from bridge.cli import (
    figures as inspect,
)
from bridge.cli import (
    line,
    looking,
    processes,
    record,
    recordings,
    replay,
    stability,
    valve,
)
from bridge.cli import (
    run as running,
)
from bridge.cli.app import LOOK, PROCESSES, RUN, app

PANELS = {
    RUN: (running.run, running.check),
    LOOK: (
        running.scenarios,
        running.schema,
        inspect.describe,
        inspect.convergence,
        stability.advise,
        stability.map_stability,
        looking.view,
        looking.report,
        recordings.info,
        recordings.compare,
        recordings.recover,
        recordings.export,
        inspect.digest,
        inspect.messages,
        inspect.figures,
        inspect.figure,
        line.line,
        inspect.doctor,
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
