"""Stability of the sampled loop."""
