"""Other people's tools: what carries a rig to them, and them to a rig."""
