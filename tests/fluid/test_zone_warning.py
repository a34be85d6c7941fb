"""A ship that starts where waves are damped is told of."""

import pytest

from ocean_sim.reading.scene import load

TANK = {
    "basin": {"length": 6.0, "width": 2.0, "depth": 1.0, "walls": {"x_max": {"kind": "absorbing", "length": 2.0}}},
    "fluid": {"kind": "delta_sph", "spacing": 0.1},
}


@pytest.mark.parametrize("x, told", [(0.5, False), (2.0, True)])
def test_a_ship_in_an_absorbing_zone_is_told_of(x, told):
    shape = {"kind": "box", "length": 0.5, "breadth": 0.5, "height": 0.4}
    hull = {"shape": shape, "mass": 60.0, "centre_of_mass": [0.0, 0.15, 0.0]}
    scene = load({**TANK, "ship": {"kind": "pressure", "hull": hull, "position": [x, 0.0]}})
    assert any("the zone before absorbing side x_max" in each for each in scene.warnings()) == told
