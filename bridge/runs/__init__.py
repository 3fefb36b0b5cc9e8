"""Whole runs of a scenario: run, check, convergence, and the picture of a run."""
