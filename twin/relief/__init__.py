"""The two-stage relief valve."""
