"""Seats of poppet valves: what oil does in the gap, in closed form or by a boundary value problem."""
