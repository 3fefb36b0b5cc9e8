"""Which gains settle after which motion: a reduced nonlinear drive under the sampled law.

`drive` is the model, `reduce` makes it of a circuit, `linear_law` is what is kept of a controller, `run` lets both
move, `swing` measures what is left of it, `edges` finds the gains. Units are SI.
"""
