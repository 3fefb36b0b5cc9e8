"""Recordings at work again: on the bus with their own timing, or as inputs of a controller or of the twin."""
