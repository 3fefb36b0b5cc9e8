"""Estimation: an ensemble of twins beside a rig, corrected by what the card reads."""
