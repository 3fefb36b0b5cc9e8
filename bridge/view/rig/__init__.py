"""The rig in three dimensions."""
