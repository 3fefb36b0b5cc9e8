"""What somebody needs to know, beside the messages themselves, to write a controller in any language."""

from bridge.wire.link import DEFAULT_ENDPOINT

TOKEN = "alive/controller"  # below the rig's name, and before a number
HEADER = "00 01 00 00"

GUIDE = f"""\
Payloads are CDR, little endian: 4 bytes of header ({HEADER}), then the fields in order. All times are nanoseconds of
simulated time, all other quantities SI. <rig> is `rig` unless the scenario's rig_name says otherwise.

A controller of your own, in any language that has Zenoh:
 1. Open a Zenoh session in client mode, connected to the plant's address: by default {DEFAULT_ENDPOINT}; the plant is
    told another one with --listen. Wait for it: with `hydrotwin run --external` the plant starts with the command.
 2. Subscribe to <rig>/measurement.
 3. Query <rig>/scenario. The answer is JSON: run_id (text), mode, tick (where the run stands), and scenario. In
    scenario.loop, in seconds: sample_period, offset and delay of the controller, daq_period (from measurement to
    measurement) and step (of the simulation). scenario.reference is what the run is to follow, scenario.controller
    the law that it is made for. Whoever starts later than the plant finds it the same way.
 4. Declare the liveliness token <rig>/{TOKEN}/NUMBER, with any number of your own such as the process id. With
    `run --external` and with `plant --await controller` the plant waits for it. Undeclare it, or close, when you leave.
 5. Answer each measurement whose stamp is offset + i * sample_period, i = 0, 1, 2, .. with one message on
    <rig>/command: run_id and stamp (as sample_stamp) of the measurement, source a random 64-bit number of your own,
    sequence counting your commands from 0, apply_at = sample_stamp + delay, spool from -1 to 1; positive lifts.
    In lockstep the plant waits for each of them; in real time they must come before apply_at.
 6. Attach 16 bytes to each message, two numbers little endian (`struct` <qQ): the stamp that it answers (int64) and its
    sequence (uint64). Without this a command and a reference are recorded all the same, anything else is not.
 7. Publish on <rig>/reference what you steer to, with each command: the run is then judged against that. Without it
    the run is judged against the scenario's own reference.
 8. Read <rig>/event. `refused` with your source says why a command was not taken; `second controller` in it means that
    the plant belongs to somebody else: leave. `safe`: the valve is centred, since no command came for
    scenario.loop.command_timeout. Where that is latched, `hydrotwin reset` or 5 bytes ({HEADER} 00) on
    <rig>/reset leave it.
 9. The run is over when <rig>/status comes with role plant and another phase than running or safe.
"""
