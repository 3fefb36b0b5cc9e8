"""What somebody needs to know, beside the messages themselves, to write a controller in any language."""

from bridge.wire.link import DEFAULT_ENDPOINT
from bridge.wire.messages import Reason

TOKEN = "alive/controller"  # below the rig's name, and before a number
HEADER = "00 01 00 00"
REASONS = ", ".join(Reason)

GUIDE = f"""\
Payloads are CDR, little endian: 4 bytes of header ({HEADER}), then the fields in order. A number of n bytes is aligned
to n, counted after the header; text is its length (uint32, with the closing NUL) and UTF-8; an array is its length
(uint32) and its elements. In the `struct` formats 4x skips the header when reading; when writing put {HEADER} there.
All times are nanoseconds of simulated time, all other quantities SI. <rig> is `rig` unless the scenario's rig_name says
otherwise.

A control law in Python or C needs nothing of this: our controller calls it (docs/running.md; `hydrotwin messages --c`
prints the header of a law in C). A controller of your own, in any language that has Zenoh:
 1. Open a Zenoh session in client mode, connected to the plant's address: by default {DEFAULT_ENDPOINT}; the plant is
    told another one with --listen. With `hydrotwin run --external` the plant starts with the command, and waits
    --patience seconds for you. Until it listens opening fails: try again every 0.2 s.
 2. Subscribe to <rig>/measurement.
 3. Query <rig>/scenario. A query that ends without a reply means "not yet": the plant listens before it answers, so
    repeat it; without an answer for 3 s close the session and open a new one. The answer is JSON: run_id (decimal, as
    text; the same for the same seed and rig), mode ("realtime" or "lockstep"), speed (simulated over wall time), tick
    (where the run stands) and scenario.
    In scenario.loop, in seconds: sample_period, offset and delay of the controller, daq_period (from measurement to
    measurement) and step (of the simulation). Whoever starts later than the plant finds it the same way.
    scenario.reference is what the run is to follow: kind "constant" holds value [m]; "step" goes from start to end [m]
    at the time `at` [s]; other kinds (square, ramp, sine, chirp, table) are in `hydrotwin schema`.
    scenario.daq.channels names further channels of the card, in the order of their numbers on <rig>/channels, which
    comes just before the measurement of the same sequence; without any there is no such message. `hydrotwin messages
    --scenario X` prints its layout and all that a channel may read.
    position runs from 0 to scenario.rig.cylinder.stroke in the direction in which port A drives the piston (of the
    thesis's rig upwards; of a motor it is the arc at the radius of its load). p2 is the pressure of the chamber at
    port A, p_lower in bands, and p3 that at port B, p_upper; `hydrotwin messages --scenario X` says which side of
    whose drive they are. A spool of 1 is scenario.rig.valve.full_scale volts:
    a gain of K V/% is spool = K * 100 * error / stroke / full_scale. The lands overlap by scenario.rig.valve.overlap
    (of a servo valve: scenario.rig.servo_valve.overlap_p_a and so on), a share of the spool's travel: so much does
    nothing, and the plant does not compensate for it.
 4. Declare the liveliness token <rig>/{TOKEN}/NUMBER, with any number of your own such as the process id. With
    `run --external` and with `plant --await controller` the plant waits for it; in real time its clock then starts with
    your answer to the measurement of stamp 0, or 2 s after that without one. Undeclare it, or close, when you leave.
 5. Answer each measurement whose stamp is offset + i * sample_period, i = 0, 1, 2, .. with one message on
    <rig>/command: run_id and stamp (as sample_stamp) of the measurement, source a random 64-bit number of your own, not
    0, sequence counting your commands from 0, apply_at = sample_stamp + delay, spool from -1 to 1; positive lifts.
    In lockstep the plant waits for each of them, --patience seconds: publish with congestion control "block". In real
    time a command should come before apply_at: a later one still acts, at once, and counts as late; one older than that
    in force is refused as stale. So after a stall, when measurements wait for you whose apply_at (stamp + delay) lies
    before the newest stamp that you have, answer the newest sample alone. Samples without an answer count as missing:
    of late and missing commands together scenario.real_time.late_commands says which share a good run may have.
    Publish with congestion control "drop" then.
 6. Attach 16 bytes to each message, two numbers little endian (`struct` <qQ): the stamp of the measurement that it
    answers (int64) and the sequence that stands in the message (uint64). Without this a command and a reference are
    recorded all the same, messages of other types are not.
 7. Publish on <rig>/reference what you steer to, with each command and with its run_id, source, sequence and the
    measurement's stamp: the run is then judged against that. Without it the run is judged against the scenario's own
    reference. You need not publish a status.
    What else you want to have recorded goes on <rig>/signals, with the same head: names (letters, digits and _, the
    same in every message), units and values, three lists of one length. Lines for people go on <rig>/said, as an Event
    of kind said with your source.
 8. Read <rig>/event. `refused` with your source says why a command was not taken; its text begins with the reason and
    a colon: {REASONS}. The first hundred of a kind are events; `missed` names further ones, and commands that never
    came or came after the end. `second controller` means that the plant belongs to somebody else: leave. `safe`:
    commands do not act any more, and the valve does what scenario.safety.on_trip says, since an alarm of the scenario
    has come or no command came for scenario.loop.command_timeout. The first command of all ends that, and later ones
    once the alarm is gone, unless scenario.loop.after_timeout is "latch" or the alarm latches: then every command is
    refused until somebody says reset, `hydrotwin reset` or 5 bytes ({HEADER} 00) on <rig>/reset, without attachment;
    the sequence goes on counting. No event but `safe` says that it is latched: the phase of <rig>/status does, and the
    refusals. Go on sending meanwhile, in lockstep the plant waits for it; whether to reset is for a person to say.
 9. The run is over when <rig>/status comes with role plant and another phase than running, degraded, safe or latched.
    Wait for that and not for the event `ended`, which may be lost; the phase is no verdict on the run.
    If the plant dies no status comes: its liveliness token <rig>/alive/plant/* is gone then.

Faults of the link (scenario.fault with a target link.measurement or link.command) let measurements come late, twice,
out of order or never. Answer a sample once, and none that is older than the last that you have answered: in lockstep
the plant waits for those answers and no others. A fault is told on <rig>/event, kind `fault`, when it begins and ends;
a query to <rig>/fault with {{"target": "sensor.p2", "kind": "stuck", "lasts": "2 s"}} injects one, and
{{"end": "sensor.p2 stuck"}} ends it (docs/faults.md).

Numbers may change while the loop runs. `changed` on <rig>/event says which and from when on (apply_at, ns); its text is
"NAME = VALUE" in SI, and perhaps "over N ns", for what somebody has set, and "timeline K: ..." for the scenario's own
timeline, where K is the field command. A query to <rig>/parameters lists the numbers, one to <rig>/parameters/set with
the payload {{"set": {{"NAME": VALUE}}}} changes them.
"""
