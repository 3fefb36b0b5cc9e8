"""Sweeps of what a run is judged by: a scenario run at every combination of some of its values."""
