"""MCAP files: writing in a stable order, reading back, digests."""
