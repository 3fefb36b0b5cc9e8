"""Values of a scenario found by search: the smallest of a metric, within bands."""
