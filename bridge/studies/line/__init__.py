"""Waves in one line."""
