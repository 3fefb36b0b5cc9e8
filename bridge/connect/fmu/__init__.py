"""FMUs, the exchange format for simulation models (FMI 2.0 and 3.0): the plant or a controller of a scenario as one."""
