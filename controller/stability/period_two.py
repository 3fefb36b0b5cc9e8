"""Orbits of period two of the sampled loop about the whole actuator: born where a multiplier passes -1, then followed.

An orbit repeats after two samples, x = P(P(x)), P of `stroboscope`; near its birth the command only changes sign, |u|
being the same all the time. There the square-root valve does, to first order in the swing, what a damping of the
pressure difference a = alpha (y3 - y4) does: u > 0 gives a' = -2 z2 + sqrt2 gamma u (1 - a/(2 alpha)), u < 0 the mirror
image, so

    a' = -2 z2 - g a + sqrt2 gamma u,   g = gamma |u|/(sqrt2 alpha).

So the orbit of opening |u| stands at the flip of that linear loop: the law of the amplitude is linear, not quadratic,
and its slope says whether the flip is soft (stable orbits beside the unstable rest) or hard.
"""

from collections.abc import Iterator
from dataclasses import replace  # noqa: F401
from itertools import islice
from typing import NamedTuple

import numpy as np

from controller.stability.branch import branch
from controller.stability.crossing import Spectrum
from controller.stability.curves import flip_gain
from controller.stability.held import Held
from controller.stability.plant import SQRT2, Array, Plant, linear_actuator
from controller.stability.sampled import SampledLoop, closed, sampled_loop
from controller.stability.simulate import Sampled
from controller.stability.stroboscope import command, period, scale_of
