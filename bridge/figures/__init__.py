"""The figures of the thesis, drawn again from the twin, and its circuit: each a picture and the table behind it.

A figure has the number it has in the thesis. Its numbers are computed apart from its drawing; both are the same at
every run.
"""
