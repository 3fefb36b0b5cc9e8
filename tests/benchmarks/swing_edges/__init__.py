"""The table of edges: those of the twin, on recorded maps of its runs, beside the intervals of `hydrotwin advise`."""
