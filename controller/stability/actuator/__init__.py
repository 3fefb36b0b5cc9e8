"""The dimensionless actuator under a sampled law."""
