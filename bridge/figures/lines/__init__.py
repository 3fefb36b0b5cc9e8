"""Waves in lines."""
