"""The sampled loop's stability on the twin itself, compared with the theory of its linearisation."""
