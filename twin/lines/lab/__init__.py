"""Waves in one pipe as a laboratory: every scheme with every friction beside exact answers. No real time here.

Unknowns are p and u = rho a v, both in Pa, v positive from end 1 to end 2 everywhere:

    p_t + a u_x = 0,    u_t + a p_x = -f(u),    f = 8 nu/R^2 u + 4 nu/R^2 sum I_j (laminar, with memory)

`pipe.py` says what a case is, `friction.py` what f is, `exact.py` has the answers. `space.py` and `integrate.py` make
the method of lines, `characteristics.py` the method of characteristics, `rig_line.py` asks the lines of the rig.
"""
