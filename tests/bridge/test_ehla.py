"""The drive `ehla` agrees with an independent model of the same equations."""

import pytest

from tests.support.ehla import MODEL, columns, deviations, trajectory


@pytest.mark.parametrize(("step", "metres", "bar"), [(50e-6, 0.01e-3, 0.15), (100e-6, 0.02e-3, 0.5)])
def test_ehla_follows_the_independent_model(step: float, metres: float, bar: float):
    """Found: 0.003 mm and 0.1 bar at 50 us, 0.011 mm and 0.4 bar at 100 us, the pressures in the return most."""
    found = deviations(trajectory(step), columns(MODEL))
    assert found.pop("position_m") <= metres
    assert max(found.values()) <= bar * 1e5
