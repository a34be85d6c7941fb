"""Targets: the water, the ship, both or none of them; what a wind does not act on feels still air."""

from typing import ClassVar

import numpy as np
import pytest

from ocean_sim.parts import WindConfig
from ocean_sim.reading.idle import idle_keys

KINDS = {
    "stress": {"u10": 20.0},
    "gusts": {"volumes": [{"include": [{"kind": "sphere", "radius": 9.0}], "acceleration": [1.0, 0.0, 0.0]}]},
    "vortex": {"acceleration": 1.0},
}
POINT, UPWARDS = [[5.0, -0.1, 1.0]], (0.0, 1.0, 0.0)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("targets", [[], ["fluid"], ["ship"], ["fluid", "ship"]])
def test_only_targets_feel_the_wind(build, force, kind, targets):
    wind = build(kind, targets=targets, **KINDS[kind])
    wind.advance(0.01)
    for target in ("fluid", "ship"):
        felt = force(wind.on(target), POINT, area=UPWARDS)
        assert bool(np.abs(felt).max() > 0.0) == (target in targets)
    assert wind.on("fluid").needs_area == (kind == "stress" and "fluid" in targets)


PLACE = [{"kind": "sphere", "radius": 9.0}]
FOR_WATER = {"include": PLACE, "acceleration": [1.0, 0.0, 0.0], "targets": ["fluid"]}
FOR_THE_SHIP = {"include": PLACE, "wind_speed": 20.0, "heading_deg": 0.0, "lift_coefficient": 0.0, "targets": ["ship"]}
FOR_ALL = {"include": PLACE, "acceleration": [0.0, 4.0, 0.0], "noise": [0.0, 1.0, 0.0]}
FOR_NOBODY = {"include": PLACE, "acceleration": [0.0, 0.0, 8.0], "targets": []}


def test_volumes_have_targets_of_their_own(build, force):
    volumes = [FOR_NOBODY, FOR_WATER, FOR_THE_SHIP, FOR_ALL]
    wind = build("gusts", volumes=volumes)
    wind.advance(0.01)
    water, ship = (force(wind.on(target), POINT, area=UPWARDS)[0] for target in ("fluid", "ship"))
    assert water[0] == 1.0 and water[2] == 0.0 and 3.0 < water[1] < 5.0 and water[1] != 4.0
    assert ship[0] == pytest.approx(0.0, abs=1e-12) and ship[2] > 0.1
    assert ship[1] == pytest.approx(water[1], rel=1e-12)  # the same draw of the noise: it goes by the volume's number
    assert not wind.on("fluid").needs_area  # what pushes by area is the ship's
    assert force(wind, POINT, area=UPWARDS)[0][2] > 8.0  # all of them, were nothing aimed


@pytest.mark.parametrize("targets", [[], ["fluid"], ["ship"], ["fluid", "ship"]])
def test_a_volume_without_targets_has_those_of_the_wind(build, force, targets):
    wind = build("gusts", volumes=[FOR_WATER, {k: v for k, v in FOR_ALL.items() if k != "noise"}], targets=targets)
    for target, own in (("fluid", 1.0), ("ship", 0.0)):
        np.testing.assert_allclose(
            force(wind.on(target), POINT)[0], [own, 4.0 if target in targets else 0.0, 0.0], atol=1e-12
        )


def yacht_in(wind: dict):
    from ocean_sim.reading.scene import load

    quiet = dict.fromkeys(("accuracy", "timings", "frames", "render", "report", "motion"))
    sea = {"basin": {"length": 90.0, "width": 90.0, "depth": 20.0, "walls": "none"}, "ship": {"kind": "yacht"}}
    return load(sea | {"fluid": {"kind": "linear_waves", "height": 0.0, "period": 5.0}, "wind": wind}, quiet)


@pytest.mark.parametrize("heading_deg, across", [(0.0, 4.6), (90.0, 14.7)])
def test_that_the_wind_on_a_ship_is_weak_is_told(heading_deg, across):
    """By as much as it is: against 0.9 on the area across the wind, breadth or length times freeboard."""
    from ocean_sim.conventions import AIR_DENSITY
    from ocean_sim.simulation import Simulation

    scene = yacht_in({"kind": "stress", "u10": 15.0, "heading_deg": heading_deg})
    with Simulation(scene) as simulation:
        simulation.step()
        ship = simulation.ship
        drag = np.linalg.norm(ship.last.parts[ship.parts.index("wind_drag")][0])
    real = 0.5 * AIR_DENSITY * 0.9 * across * 2.15 * 15.0**2
    assert 15.0 < real / drag < 70.0
    assert any(
        "the ship is that of the sea's surface" in said and "15 to 70 times" in said for said in scene.warnings()
    )


def test_a_wind_that_a_ship_does_not_feel_is_not_told():
    for keys in ({"targets": ["fluid"]}, {"u10": 0.0}):
        scene = yacht_in({"kind": "stress", "u10": 15.0} | keys)
        assert not any("sea's surface" in said for said in scene.warnings())


class OnWater(WindConfig):
    """A kind of one's own that pushes the water alone, with a key that another kind has too."""

    kind: str = "on_water"
    u10: float = 10.0
    acts_on: ClassVar[tuple[str, ...]] = ("fluid",)

    def ledger(self, preflight):
        return []

    def build(self, basin, seed):
        raise NotImplementedError


def test_a_kind_that_acts_on_no_ship_is_told_and_its_keys_need_no_other_kinds_keys():
    known = yacht_in({"kind": "still"}).preflight
    wind = OnWater(u10=5.0)
    assert wind.needs_area and not wind.needs_bend
    assert list(wind.warnings(known)) == ["wind: on_water does not act on ships; it leaves the ship in still air"]
    assert list(idle_keys({"wind": wind}, known)) == []
