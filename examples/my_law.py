"""Your own control law as a function, run by hydrotwin's controller process.

Usage: hydrotwin controller --law my_law:law, or hydrotwin run step --set controller.law=my_law:law, in this folder.
"""


def law(sample, target, memory, gains):
    """Steer to the target: jump over the valve's dead band, then in proportion. Returns (spool -1..1, memory).

    `sample` has stamp_ns, position [m], velocity [m/s] and p1, p2, p3 [Pa]; `target` position and velocity; `gains`
    what the scenario sets. `memory` is yours: None at the first sample, then what you returned at the last one.
    It is None again when the plant has centred its valve, or takes commands again; functions of yours with the names
    on_safe_state(memory) and on_resume(memory) are told of it instead, and return the memory to go on with.
    """
    error = target.position - sample.position
    spool = gains.proportional * error + (gains.overlap if error > 0.0 else -gains.overlap)
    return max(-gains.limit, min(gains.limit, spool)), memory
