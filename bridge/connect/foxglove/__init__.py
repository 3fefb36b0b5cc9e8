"""A rig in Foxglove: a live server with a channel per topic, parameters, services and a replay's controls."""
