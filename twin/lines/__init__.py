"""Pipes and hoses. A line has two ends; components meet only there. `bank.py` is the door."""
