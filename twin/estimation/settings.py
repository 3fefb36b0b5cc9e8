"""How an estimate is made: plain numbers, assumed where nothing else is said."""

from collections.abc import Mapping
from typing import NamedTuple

from twin.estimation.unknowns import Prior
from twin.topology import CHANNELS


class Settings(NamedTuple):
    """Of one estimate."""

    members: int = 24  # twins in the ensemble
    every: int = 5  # scans between two corrections; each uses all scans since the last
    without: tuple[str, ...] = ()  # channels that are looked at and not used
    unknowns: Mapping[str, Prior] = {}  # in place of those of `UNKNOWNS`
    inflation: float = 0.05  # growth of the deviations by themselves [1/s], for what so few members miss; of unknowns
    # up to those that were known beforehand
    settling: float = 0.05  # after a beginning, until waves and flows that no scan tells have died [s]
    pressure_error: float = 0.2e5  # of the model, in what a transducer would touch [Pa]: waves at its step
    velocity_error: float = 0.5e-3  # [m/s]
    position_error: float = 20e-6  # [m]
    position_noise: float = 0.05e-3  # of the model [m/sqrt(s)]
    velocity_noise: float = 20e-3  # [m/s/sqrt(s)]: forces that it does not know; kicks out of rest, so few as can be
    pressure_noise: float = 0.5e5  # of the chambers [Pa/sqrt(s)]: flows that it does not know
    activity: float = 10.0  # how much more all of them are while the innovations are too large, at most

    def model_errors(self) -> dict[str, float]:
        """By channel, SI."""
        of_unit = {"Pa": self.pressure_error, "m/s": self.velocity_error, "m": self.position_error}
        return {name: of_unit[channel.unit] for name, channel in CHANNELS.items()}

    def noises(self) -> dict[str, float]:
        """What numbers of a flat state wander by besides [per sqrt(s)]: forces and flows that no model knows."""
        pressures = dict.fromkeys(("lower", "upper"), self.pressure_noise)
        return {"position": self.position_noise, "velocity": self.velocity_noise, **pressures}
