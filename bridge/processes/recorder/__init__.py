"""The recorder: what the bus carries, written to MCAP in order, parts and rings."""
