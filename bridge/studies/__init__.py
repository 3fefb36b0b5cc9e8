"""Computations around the loop: stability, valves, one line, and sweeps that serve them."""
