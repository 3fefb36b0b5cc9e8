"""Campaigns: a matrix of scenarios, faults, parameters and seeds, every run judged by the bands of its scenario."""
