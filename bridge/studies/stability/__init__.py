"""The sampled loop's stability on the twin itself, beside the theory of its linearisation."""
