"""Ships that fall into the water, against published series of wedges and spheres, and what is told of it."""

import json
from math import pi, radians, tan
from pathlib import Path

import numpy as np
import pytest

from ocean_sim.observers import health
from ocean_sim.reading.scene import load
from ocean_sim.ship.forces.added_mass import WAGNER_FACTOR, Slamming, entry_curve, pabst_factor
from ocean_sim.ship.hull.hull import Hull
from ocean_sim.ship.hull.shapes import Outline, Sphere
from ocean_sim.ship.naval.hydrostatics import Hydrostatics
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.ship import floating_ship

DENSITY, G, LENGTH = 1000.0, 9.81, 4.0


def wedge(degrees: float) -> Hydrostatics:
    """A prism 2 m broad and LENGTH long, in fine cubes, that floats with its chines wet."""
    high, ends = tan(radians(degrees)), (-LENGTH / 2.0, LENGTH / 2.0)
    points = [(x, y, z) for x, y in ((0.0, 0.0), (1.0, high)) for z in ends]
    hull = Hull(shape=Outline(kind="outline", points=points), mass=0.98 * DENSITY * high * LENGTH)
    return hull.in_cubes(high / 16.0, DENSITY, G)


# F / (rho V^3 t) a metre of length by deadrise, of Dobrovol'skaya's similarity solution as Zhao & Faltinsen (1993) are
# quoted for it. The paper itself was not at hand: the numbers are not checked against it, but for the test below.
SIMILARITY = {4.0: 1503.638, 7.5: 399.816, 10.0: 213.980, 15.0: 85.522, 20.0: 42.485, 30.0: 14.139, 40.0: 5.477}


def test_the_similarity_solutions_tend_to_wagners():
    """Wagner's force pi^3 / (4 tan^2) is their limit at a small deadrise; they fall below it evenly, by 0.72 to 0.82 a
    radian, so that a wrong digit or a wrong row would be seen."""
    shares = np.array([f / (pi**3 / 4.0 / tan(radians(b)) ** 2) for b, f in SIMILARITY.items()])
    lost = (1.0 - shares) / np.radians(list(SIMILARITY))
    assert ((0.70 < lost) & (lost < 0.83)).all() and (np.diff(lost[2:]) < 0.0).all()


@pytest.mark.parametrize(("degrees", "within"), [(10.0, 0.05), (20.0, 0.05), (30.0, 0.05), (40.0, 0.2)])
def test_a_wedge_enters_at_a_steady_speed_as_similarity_has_it(degrees, within):
    """A grows with the square of the depth, so that F = 2 A V / t. RISE was fitted to these numbers: this shows that
    the cubes keep to the fit, not that the fit is right."""
    hull = wedge(degrees)
    volume, moved = entry_curve(hull)
    k = 8  # layers under water: half of it, before the chines are wet
    depth, breadth = k * hull.voxels.size[1], 2.0 * k / 16.0
    assert volume[k] == pytest.approx(0.5 * breadth * depth * LENGTH, rel=0.05)
    found = 2.0 * moved[k] / LENGTH / pabst_factor(LENGTH / breadth) / (DENSITY * depth**2)
    assert found == pytest.approx(SIMILARITY[degrees], rel=within)


def test_a_sphere_enters_between_von_karman_and_wagner():
    """Both of a disc, 4/3 rho c^3 (von Karman 1929 with c^2 = 2 R h - h^2, Wagner 1932 with 3 R h), while it is
    flat where it enters; sections by strips are not a disc, within a quarter."""
    hull = Hull(shape=Sphere(kind="sphere", radius=1.0), mass=2000.0).in_cubes(1.0 / 24.0, DENSITY, G)
    volume, moved = entry_curve(hull)
    depth = hull.voxels.size[1] * np.arange(len(volume))
    for h in (0.05, 0.1, 0.2):
        found = np.interp(h, depth, moved)
        karman, wagner = (4.0 / 3.0 * DENSITY * c2**1.5 for c2 in (2.0 * h - h * h, 3.0 * h))
        assert karman < found < 1.25 * wagner
    assert np.interp(0.05, depth, moved) == pytest.approx(4.0 / 3.0 * DENSITY * 0.15**1.5, rel=0.25)


def test_momentum_of_hull_and_water_is_kept_whatever_the_step():
    """(m + A) V: von Karman's wedge, without gravity; what leaves the water and enters again pays again, what bobs in
    it does not."""
    hull = wedge(20.0)
    usual = float(entry_curve(hull)[1][-1])
    speeds = []
    for steps in (5, 50):
        slamming, speed = Slamming(hull, usual), -3.0
        for volume in np.linspace(0.0, slamming.volume, steps + 1):
            speed += slamming.push(volume, speed, 0.01) / slamming.mass * 0.01
        speeds.append(speed)
        afloat = slamming.added(slamming.volume)
        assert speed == pytest.approx(-3.0 * slamming.mass / (slamming.mass + afloat), rel=1e-9)
        bobs = [slamming.push(v, -1.0, 0.01) for v in (0.2 * slamming.volume, slamming.volume, 0.5 * slamming.volume)]
        assert not any(bobs)
        assert slamming.push(0.0, -1.0, 0.01) == 0.0 and slamming.push(0.2 * slamming.volume, -1.0, 0.01) > 0.0
    assert WAGNER_FACTOR == pytest.approx(pi**2 / 4.0)


def test_the_acceleration_of_a_slam_converges_with_the_step():
    """A step has the impulse of all that it wets, so its acceleration is a mean over the step: the peak of a wedge
    tends to that of V = m V0 / (m + A), m^2 V0^2 A' / (m + A)^3 where it is largest, A being linear in a layer."""
    hull = wedge(20.0)
    slamming = Slamming(hull, 1e9)
    height = hull.voxels.size[1] * np.arange(len(slamming.volumes))

    def peak(dt: float) -> float:
        depth, speed, found = 0.0, 3.0, 0.0
        slamming.push(0.0, -speed, dt)
        while depth < 0.8 * height[-1]:
            depth += speed * dt
            a = slamming.push(float(np.interp(depth, height, slamming.volumes)), -speed, dt) / slamming.mass
            speed, found = speed - a * dt, max(found, a)
        return found

    m, moved = slamming.mass, np.array([slamming.added(volume) for volume in slamming.volumes])
    exact = float((9.0 * m**2 * np.diff(moved) / np.diff(height) / (m + moved[:-1]) ** 3).max())
    off = [abs(peak(0.02 / 8**k) / exact - 1.0) for k in range(4)]
    assert off[0] > 0.3 and off[1] < 0.4 * off[0] and off[2] < 0.5 * off[1] and off[3] < 0.01


def dropped(kind: str, height: float, folder: Path) -> tuple[np.ndarray, list[dict], list[str]]:
    """Rise over afloat [m] and the hull's energy over its weight [m] step by step, the events, and the warnings."""

    def scene(**ship):
        quiet = dict.fromkeys(("accuracy", "frames", "render", "report", "timings", "motion", "health"))
        water = {"kind": "linear_waves", "height": 0.0, "period": 6.0}
        basin = {"length": 60.0, "width": 60.0, "depth": 20.0}
        return load({"basin": basin, "fluid": water, "ship": {"kind": kind, "hull": "yacht"} | ship, **quiet})

    with Simulation(scene()) as simulation:
        afloat = float(floating_ship(simulation).body.position[1])
    config = scene(position=[0.0, afloat + height, 0.0])
    with Simulation(config) as simulation:
        simulation.observers = [health.Config().build(folder, simulation)]
        path = []
        while simulation.time < 8.0:
            simulation.run(simulation.time + simulation.next_dt)
            body = floating_ship(simulation).body
            rise = body.position[1] - afloat
            path.append((rise, rise + body.kinetic_energy() / body.mass / G))
    events = [json.loads(line) for line in (folder / "events.jsonl").read_text().splitlines()]
    return np.array(path), events, config.warnings()


@pytest.mark.parametrize("kind", [pytest.param("hydrostatic", marks=pytest.mark.slow), "dynamic"])
def test_a_yacht_from_5_m_up_comes_to_float(kind, tmp_path):
    """It rebounded to 3.41 (hydrostatic) and 2.23 m (dynamic); she may leave the water once more, not by her own
    height of fall, and no energy comes from nowhere."""
    path, events, warnings = dropped(kind, 5.0, tmp_path)
    rise = path[:, 0]
    first = int(np.argmax(rise < 0.0))
    assert rise[first:].max() < 1.0
    assert np.ptp(rise[-40:]) < 1.0
    assert path[:, 1].max() < 5.0 + 0.05
    told = [event for event in events if event["event"].startswith("the hull")]
    assert [event["event"].split()[2] for event in told[:2]] == ["leaves", "meets"]
    assert told[1]["speed_m_s"] == pytest.approx(-np.sqrt(2.0 * G * (5.0 - 1.05)), rel=0.05)
    assert any("begins 5 m above where it floats" in warning for warning in warnings)


def test_a_ship_that_begins_under_water_is_told():
    scene = {"basin": {"length": 60.0, "width": 60.0, "depth": 20.0}, "ship": {"kind": "yacht"}}
    scene["fluid"] = {"kind": "linear_waves", "spectrum": {"significant_wave_height": 1.0, "peak_period": 6.0}}
    told = "its whole hull under water"
    for height, deep in ((0.0, False), (-9.0, True)):
        warnings = load(scene, {"ship.position": [0.0, height, 0.0]}).warnings()
        assert any(told in warning for warning in warnings) == deep


@pytest.mark.slow
def test_a_yacht_that_begins_a_little_high_is_told_nothing_and_slams_nothing(tmp_path):
    path, events, warnings = dropped("dynamic", 0.4, tmp_path)
    assert not any("begins" in warning for warning in warnings)
    assert not [event for event in events if event["event"].startswith("the hull")]
    assert abs(path[-1, 0]) < 0.4
