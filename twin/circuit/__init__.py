"""The whole circuit: its state, step, rest, limits, linear model."""
