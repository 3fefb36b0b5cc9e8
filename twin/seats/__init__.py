"""Seats of poppet valves: what oil does in the gap, in closed form and, where there is none, as a boundary value problem."""
