"""Periodic orbits, their multipliers and their continuation."""
