"""Numbers of a rig found from recordings: simulated signals against measured ones, and what the data can tell."""
