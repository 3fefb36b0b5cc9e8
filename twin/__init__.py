"""The plant: physics and numerics of the rig. No clock, no network, no files, no printing."""
