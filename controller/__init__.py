"""The controller: references, control laws, metrics of a run, and stability theory; no clock, file or network."""
