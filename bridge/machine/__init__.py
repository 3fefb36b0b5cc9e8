"""The machine below the loop: clock, signals and rights of a process, host, doctor."""
