"""The controller: references, control laws, the hold, metrics of a run; no clock, file or network."""
