"""Verbs that are processes of the loop: plant, controller, router, reset."""

import time
from typing import Annotated

import typer

from bridge.cli.options import (
    AS_JSON,
    CHANGES,
    CONFIG,
    CONNECT,
    JOIN,
    LISTEN,
    MODE,
    PATIENCE,
    PRIORITY,
    QUIET,
    SCENARIO,
    ProcessMode,
    address,
    seconds,
)
from bridge.cli.outputs import print_json
from bridge.machine.priority import Priority
from bridge.wire.link import DEFAULT_ENDPOINT
from bridge.wire.messages import Mode


def plant(
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    mode: MODE = ProcessMode.REALTIME,
    speed: Annotated[float, typer.Option(min=0.01, max=100.0, help="Simulated seconds per second.")] = 1.0,
    listen: LISTEN = None,
    connect: JOIN = None,
    zenoh_config: CONFIG = None,
    run_id: Annotated[
        int | None, typer.Option(help="Identity of the run. [default: random]", show_default=False)
    ] = None,
    partners: Annotated[
        list[str] | None,
        typer.Option("--await", metavar="ROLE", help="controller or recorder: start once it is there."),
    ] = None,
    patience: Annotated[
        float,
        typer.Option(help="Seconds to wait for partners, and in lockstep for commands.", callback=seconds),
    ] = 10.0,
    priority: PRIORITY = Priority.AUTO,
    quiet: QUIET = False,
    as_json: AS_JSON = False,
) -> None:
    """Simulate the rig: publish measurements, take valve commands.

    It holds no control law. In real time it starts at once and keeps the valve centred until a controller speaks. With
    --await controller it waits until one is there, and then up to 2 s for its first command. In lockstep it waits for
    each command.
    """
    from bridge.scenario import load
    from bridge.scenario.loading import refuse_fast_daq

    checked = load(scenario, changes)
    if mode == ProcessMode.REALTIME:
        refuse_fast_daq(checked, speed)
    from bridge.loop.identity import fresh
    from bridge.processes.plant import PlantOptions, run_plant
    from bridge.wire.link import Link

    link = Link(listen or (None if connect or zenoh_config else DEFAULT_ENDPOINT), connect, zenoh_config, patience)
    awaited = tuple(partners or (["controller"] if mode == ProcessMode.LOCKSTEP else []))
    options = PlantOptions(Mode(mode), speed, priority, fresh() if run_id is None else run_id, awaited, patience, quiet)
    words = run_plant(checked, link, options).plain()
    if as_json:
        print_json(words)
    else:
        print("\n".join(f"{name:24} {value:g}" for name, value in words.items() if isinstance(value, int | float)))


def controller(
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    law: Annotated[
        str | None,
        typer.Option(help="Your own law as module:function or FILE.py:function; or one of our kinds, such as pd."),
    ] = None,
    mode: MODE = ProcessMode.REALTIME,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    source: Annotated[
        int | None, typer.Option(help="Identity of this controller. [default: random]", show_default=False)
    ] = None,
    patience: PATIENCE = 10.0,
    priority: PRIORITY = Priority.AUTO,
    quiet: QUIET = False,
) -> None:
    """Answer measurements with valve commands until the plant ends.

    With --law module:function or FILE.py:function the law is yours: a function of (sample, target, memory, gains)
    that returns (spool, memory), or (spool, memory, signals) with numbers by name that are to be recorded. memory is
    None at the first sample, and again when the plant goes to its safe state or leaves it. Functions
    on_safe_state(memory) and on_resume(memory) beside it are told of that instead.
    """
    from bridge.scenario import load
    from bridge.scenario.controllers import changes_for

    own = changes_for(law) if law else []
    checked = load(scenario, [*(changes or []), *own])
    from bridge.loop.identity import fresh
    from bridge.processes.controller import run_controller
    from bridge.wire.link import Link

    link = Link(None, connect, zenoh_config, patience)
    run_controller(checked, link, Mode(mode), fresh() if source is None else source, priority, quiet)


def router(
    listen: Annotated[str, typer.Option(help="Address to listen on.", callback=address)] = "tcp/0.0.0.0:7447",
    zenoh_config: CONFIG = None,
) -> None:
    """Route between machines until interrupted; plants and clients use --connect."""
    from bridge.processes.router import run_router

    run_router(listen, zenoh_config)


def reset(
    rig: Annotated[str, typer.Option(help="Name of the rig.")] = "rig",
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    as_json: AS_JSON = False,
) -> None:
    """Bring a plant out of its safe state."""
    from bridge.wire.bus import Bus
    from bridge.wire.link import Link

    with Bus(Link(None, connect, zenoh_config, 2.0), rig, "operator", blocking=True) as bus:
        bus.session.put(f"{rig}/reset", b"\x00\x01\x00\x00\x00")
        time.sleep(0.1)
    if as_json:
        print_json({"reset": rig})
    else:
        print(f"hydrotwin: reset sent to {rig}")
