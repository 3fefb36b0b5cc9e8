"""Colours of bodies in the 3-D picture of the rig."""

STEEL, DARK, GLASS, BRASS, PAPER = (176, 184, 194), (92, 100, 112), (150, 170, 190, 40), (208, 168, 92), (228, 232, 238)
BLUE, COPPER, WATER, RED = (78, 112, 160), (176, 108, 70), (90, 130, 180, 60), (220, 90, 70)
GAS, GREEN = (120, 200, 170), (86, 150, 110)
