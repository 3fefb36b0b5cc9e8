"""Seal friction."""
