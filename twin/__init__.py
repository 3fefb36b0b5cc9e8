"""The plant: physics and numerics of the rig. No clock, no network, no printing, and no files
but the cache of compiled code."""
