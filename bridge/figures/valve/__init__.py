"""Valve seats, static curve, chatter."""
