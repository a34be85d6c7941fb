"""Ships of the MMG model: closed forms of a gentle turn and of waves, symmetry, and wind."""

from math import asin, pi, radians

import numpy as np
import pytest

from ocean_sim.conventions import AIR_DENSITY, GRAVITY
from ocean_sim.files import yaml_file
from ocean_sim.fluid import Arriving
from ocean_sim.parts import library
from ocean_sim.reading.scene import SceneError, load, observer_names
from ocean_sim.ship.manoeuvring import Windage, wave_motion
from ocean_sim.simulation import Simulation
from ocean_sim.validation.ship_simman import set_steady_throttle

QUIET = {name: None for name in observer_names() if name != "manifest"} | {"runtime.threads": 1}
CALM = {"period": 10.0, "height": 0.0}


def at_sea(ship: dict, dt: float = 0.5, **keys) -> dict:
    return {
        "duration": 5000.0,
        "basin": {"length": 20000.0, "width": 20000.0, "depth": 500.0, "walls": "none"},
        "fluid": {"kind": "linear_waves", "ramp": 0.0} | keys.pop("fluid", CALM),
        "time_step": {"kind": "fixed", "dt": dt},
        "runtime": {"precision": "f64"},
        "ship": ship,
    } | keys


def coefficients(name: str) -> dict:
    return yaml_file.read_mapping(library("configs") / "ship" / f"{name}.yaml").plain()["mmg"]


def sailed(ship: dict, rudder: float, speed: float, until: float, **keys):
    """The ship after a run at held revolutions and a rudder [rad], positive to port, from a speed ahead [m/s]."""
    with Simulation(load(at_sea({"velocity": [0.0, 0.0, speed]} | ship, **keys), QUIET)) as simulation:
        throttle = set_steady_throttle(simulation.ship, speed)
        helm = simulation.ship.hand_over()
        while simulation.time < until:
            helm.give(throttle, rudder)
            simulation.step()
        return simulation.ship


def test_a_gentle_turn_is_that_of_the_linear_equations():
    """Sway and yaw in balance at a small rudder angle, solved for v' and r' in closed form: KCS, stable on course."""
    ship, speed, delta = sailed({"kind": "kcs"}, -radians(0.1), 12.0, 1500.0), 12.0, radians(0.1)
    c, model = ship.model.config, ship.model
    length, _, draught = c.size
    mass, far = c.volume / (0.5 * length**2 * draught), 1.0 / length
    sway, yaw = c.hull["sway"], c.hull["yaw"]
    ahead = np.array([speed, 0.0, 0.0, 0.0, 0.0, 0.0])
    inflow = model.inflow_speed(ahead)
    stream = model.stream_speed(inflow, model.bare_thrust(inflow, float(ship.revolutions[0]))) / speed
    slope = 6.13 * c.rudder.aspect_ratio / (c.rudder.aspect_ratio + 2.25)
    force = c.rudder.area / (length * draught) * slope * stream**2
    _, gamma, arm = c.rudder.straightening
    _, pushed, where = c.rudder.interaction
    side, lever = 1.0 + pushed, -0.5 + pushed * where
    # F' = force (delta + gamma (v' + l_R r') / stream), Y_R = -side F', N_R = -lever F'.
    turned = force * gamma / stream * np.array([1.0, arm])
    rows = np.array([[-sway["b"], sway["r"] - mass - c.added[0]], [-yaw["b"], yaw["r"] - mass * c.centre[0] * far]])
    rows -= np.outer([side, lever], turned)
    assert np.linalg.det(rows) > 0.0  # stable on course
    v, r = np.linalg.solve(rows, np.array([side, lever]) * force * delta)
    rate = -float(ship.body.rates[1]) * length / np.linalg.norm(ship.body.velocity)
    assert r > 0.0 and rate == pytest.approx(r, rel=0.01)
    way = ship.centred_body.own_velocity
    aside = (-way[0] - -float(ship.body.rates[1]) * c.centre[0]) / np.linalg.norm(ship.body.velocity)
    assert asin(aside) == pytest.approx(v, rel=0.01)


def test_both_sides_are_alike_but_for_the_published_flow_at_the_stern():
    """KVLCC2's circles mirror each other once the flow at propeller and rudder is made alike, and not as published."""

    def circle(side: float, alike: bool) -> np.ndarray:
        mmg = coefficients("kvlcc2")
        if alike:
            mmg["rudder"]["straightening"], mmg["propeller"]["wake_change"] = [0.5, 0.5, -0.71], [2.0, 1.3, 1.3]
        body = sailed({"kind": "manoeuvring", "mmg": mmg}, side * radians(35.0), 8.0, 600.0).body
        return np.array([side * body.position[0], body.position[2], 100.0 * side * body.angles[1]])

    mirrored, published = (np.abs(circle(1.0, alike) - circle(-1.0, alike)).max() for alike in (True, False))
    assert mirrored < 1e-6 and 10.0 < published < 100.0  # [m] in a circle of a kilometre


def test_the_rudder_holds_her_straight_and_throttle_gives_the_published_speed():
    """KCS keeps 24 knots at full throttle, with R_0 = (1 - t) K_T in closed form, and does not turn."""
    ship = {"kind": "kcs", "controls": [{"time": 0.0, "throttle": 1.0}], "windage": None}
    with Simulation(load(at_sea(ship | {"velocity": [0.0, 0.0, 10.0]}), QUIET)) as simulation:
        simulation.run(until=1500.0)
        body = simulation.ship.body
    assert np.linalg.norm(body.velocity) == pytest.approx(24.0 * 0.514444, rel=0.005)
    assert abs(body.position[0]) < 1e-6 and abs(body.angles[1]) < 1e-9


@pytest.mark.parametrize("kind, long", [("kcs", 6000.0), ("otter", 60.0)])
def test_long_waves_carry_her_as_their_surface_and_calm_water_does_not(kind, long):
    """Heave of the wave's amplitude, surge of its orbit; a wave much longer than she is meets no resonance."""
    period = (2.0 * pi * long / GRAVITY) ** 0.5
    for amplitude in (0.01 * long / 60.0, 0.0):
        waves = {"period": period, "height": 2.0 * amplitude}
        scene = at_sea({"kind": kind}, period / 400.0, fluid=waves)
        scene["basin"]["depth"] = 10.0 * long
        with Simulation(load(scene, QUIET)) as simulation:
            rows = []
            while simulation.time < 8.0 * period:
                simulation.step()
                rows.append(simulation.ship.body.position)
        last = np.array(rows[-800:])
        heave, surge = np.ptp(last[:, 1]) / 2.0, np.ptp(last[:, 2] - np.linspace(last[0, 2], last[-1, 2], 800)) / 2.0
        assert heave == pytest.approx(amplitude, rel=0.1, abs=1e-4 * long / 60.0)
        assert surge == pytest.approx(amplitude, rel=0.2, abs=1e-3 * long / 60.0)


def test_the_averages_are_those_of_the_water_in_a_box():
    """Against sums over points of the box: velocities over its volume, height and slopes over its waterplane."""
    k, depth, box = 0.03, 60.0, (230.0, 32.0, 10.8)
    omega, heading, yaw = (GRAVITY * k * np.tanh(k * depth)) ** 0.5, 0.7, 0.2
    wave = Arriving(*(np.array([x]) for x in (1.5, 0.4, omega, heading, k)))
    velocity, rate, place = wave_motion(wave, yaw, np.zeros(3), box, depth)
    ahead, port = (np.linspace(-0.5, 0.5, n) * size for n, size in ((801, box[0]), (201, box[1])))
    ahead, port = (a[:-1] + 0.5 * (a[1] - a[0]) for a in (ahead, port))
    x, y = np.meshgrid(ahead, port, indexing="ij")
    phase = 0.4 + k * (x * np.cos(heading - yaw) + y * np.sin(heading - yaw))
    z = np.linspace(-box[2], 0.0, 2001)
    level = (np.cosh(k * (depth + z)) / np.sinh(k * depth)).mean() * omega * 1.5
    upright = (np.sinh(k * (depth + z)) / np.sinh(k * depth)).mean() * omega * 1.5
    slope = lambda field, at: (field * at).mean() / (at**2).mean()
    along, across = level * np.cos(phase) * np.cos(heading - yaw), -level * np.cos(phase) * np.sin(heading - yaw)
    down = -upright * np.sin(phase)
    expected = [along.mean(), across.mean(), down.mean(), 0.0, -slope(down, x), slope(across, x)]
    np.testing.assert_allclose(velocity, expected, rtol=2e-3, atol=1e-6)
    height = 1.5 * np.cos(phase)
    np.testing.assert_allclose(place[[2, 4]], [-height.mean(), slope(height, x)], rtol=2e-3)
    later = wave._replace(angle=wave.angle - omega * 1e-5)
    faster = (wave_motion(later, yaw, np.zeros(3), box, depth)[0] - velocity) / 1e-5
    np.testing.assert_allclose(rate, faster, rtol=1e-3, atol=1e-6)


def test_first_order_motions_are_superposed_on_the_manoeuvre():
    """Her track in a head sea is that of calm water plus the water's motion at the frequency of encounter; the rest is
    of the order of a Stokes drift."""
    height, omega = 3.0, 2.0 * pi / 14.0
    tracks = []
    for amplitude in (height, 0.0):
        sea = {"period": 14.0, "height": amplitude, "heading_deg": 180.0, "ramp": 28.0}
        keys = {"kind": "kcs", "windage": None, "velocity": [0.0, 0.0, 10.0]}
        with Simulation(load(at_sea(keys, 0.1, fluid=sea), QUIET)) as simulation:
            helm = simulation.ship.hand_over()
            helm.give(set_steady_throttle(simulation.ship, 10.0), 0.0)
            rows = []
            while simulation.time < 120.0:
                simulation.step()
                body = simulation.ship.body
                rows.append([simulation.time, body.point(-simulation.ship.arm)[2], body.angles[0]])
        tracks.append(np.array(rows)[600:].T)
    (t, tossed, pitch), (_, calm, level) = tracks
    k = omega**2 / GRAVITY
    met = omega + 10.0 * k
    wave = Arriving(*(np.array([x]) for x in (height / 2.0, 0.0, omega, pi, k)))
    flow = abs(wave_motion(wave, 0.0, np.zeros(3), (230.0, 32.2, 10.8), 500.0)[0][0])
    base = np.stack([np.cos(met * t), np.sin(met * t), np.ones_like(t), t], axis=1)
    a, b, _, drift = np.linalg.lstsq(base, tossed - calm)[0]
    assert np.hypot(a, b) == pytest.approx(flow / met, rel=0.05)
    assert abs(drift) < 2.0 * k * omega * (height / 2.0) ** 2
    assert np.abs(pitch).max() > 1e-3 and np.abs(level).max() < 1e-6


def test_the_wind_pushes_her_by_her_areas_and_only_with_them():
    wind = {"kind": "stress", "u10": 20.0, "heading_deg": 90.0}
    for windage in ({"frontal": 300.0, "lateral": 2000.0}, None):
        with Simulation(load(at_sea({"kind": "kcs", "windage": windage}, wind=wind), QUIET)) as simulation:
            simulation.step()
            force = dict(zip(simulation.ship.parts, simulation.ship.last.parts, strict=True))["wind_drag"][0]
        beam = 0.5 * AIR_DENSITY * 20.0**2 * 2000.0 * 0.85
        np.testing.assert_allclose(force, [beam if windage else 0.0, 0.0, 0.0], atol=1e-6 * beam)


def test_a_bow_wind_turns_her_away():
    pushed = Windage(frontal=300.0, lateral=2000.0).wind_load(-10.0, 10.0, 230.0)
    assert pushed[0] < 0.0 and pushed[1] < 0.0 and pushed[5] < 0.0  # astern, to port, bow to port


def test_a_term_that_is_none_and_shallow_water_are_refused():
    mmg = coefficients("kcs")
    wrong = at_sea({"kind": "manoeuvring", "mmg": mmg | {"hull": {"sway": {"vu": 1.0}}}})
    with pytest.raises(SceneError):
        load(wrong)
    shallow = at_sea({"kind": "kcs"})
    shallow["basin"]["depth"] = 10.0
    with pytest.raises(SceneError) as refused:
        load(shallow)
    assert any("draws 10.8 m" in str(problem) for problem in refused.value.problems)
    told = [sentence for sentence in load(at_sea({"kind": "kcs"})).warnings() if "MMG" in sentence]
    assert "to first order, superposed, without drift" in told[0]
