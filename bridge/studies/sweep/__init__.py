"""Many independent runs: over the cores of this machine or of a cluster, resumable, with the same result."""
