"""The operator's panel: one page in a browser from which a rig is watched and operated."""
