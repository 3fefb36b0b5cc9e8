"""The rig's assumed numbers, chosen by what the thesis measured: facts, ranges, a fit, and what no choice can meet."""
