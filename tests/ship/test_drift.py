"""Drift of hulls in waves: by rule and by table, in one wave and in sums of waves, and what is said of it."""

import subprocess
import sys
from math import pi

import numpy as np
import pytest

from ocean_sim.conventions import GRAVITY
from ocean_sim.files.input_file import Unreadable
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.reading.scene import load
from ocean_sim.ship.body.rigid_body import RigidBody, euler_quaternion
from ocean_sim.ship.forces.drift import SLOW_SHARE, TABLE_COLUMNS, Drift, read_table, waterline_law
from ocean_sim.ship.hull.hull import Hull, hull_of
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import load_without_observers
from ocean_sim.validation.shared.ship import floating_ship
from ocean_sim.validation.shared.tables import table_path
from ocean_sim.verbs.check import preflight

UNIT = 0.5 * 1000.0 * GRAVITY  # rho g / 2 [N/m3]
BARGE = str(table_path("barge20_drift"))


def by_rule(hull, wavelength: float, heading: float) -> np.ndarray:
    """(3,) surge, sway [N/m2], yaw [N m/m2] by rule in waves of a length [m] to a heading [deg]."""
    k = np.array([2.0 * pi / wavelength])
    return waterline_law(hull)(np.sqrt(GRAVITY * k), k, np.radians([heading]))[:, 0]


def test_short_waves_push_a_box_as_a_wall_and_a_cylinder_by_two_thirds():
    """Maruo's limit on a wall, and 2/3 rho g a^2 r on a vertical cylinder (Faltinsen 1990, Sea Loads, 5.3)."""
    box = hull_of("barge20").in_still_water(8.0, 1000.0, GRAVITY)
    assert by_rule(box, 0.2, 90.0) / UNIT == pytest.approx([0.0, 20.0, 0.0], abs=1e-3)
    assert by_rule(box, 0.2, 180.0) / UNIT == pytest.approx([-8.0, 0.0, 0.0], abs=1e-3)
    yacht = hull_of("yacht").in_still_water(8.0, 1000.0, GRAVITY)
    assert by_rule(yacht, 0.2, 300.0) == pytest.approx(by_rule(yacht, 0.2, 60.0) * [1.0, -1.0, -1.0])
    turns = np.linspace(0.0, 2.0 * pi, 96, endpoint=False)
    points = [[float(np.cos(t)), y, float(np.sin(t))] for t in turns for y in (0.0, 3.0)]
    shape = {"kind": "outline", "points": points}
    pile = Hull.model_validate({"shape": shape, "mass": 1000.0 * pi * 2.0})
    found = by_rule(pile.in_still_water(24.0, 1000.0, GRAVITY), 0.05, 37.0) / UNIT
    assert np.hypot(*found[:2]) == pytest.approx(4.0 / 3.0, rel=0.02)
    assert np.degrees(np.arctan2(found[1], found[0])) == pytest.approx(37.0, abs=1.0)


def test_long_waves_pass_under_a_hull():
    """Ursell: of waves with k T = 1 a thin wall reflects 0.901 of their energy; of long ones nothing."""
    box = hull_of("barge20").in_still_water(8.0, 1000.0, GRAVITY)
    share = by_rule(box, 4.0 * pi, 90.0)[1] / (20.0 * UNIT)
    assert share == pytest.approx(1.0 / (1.0 + (0.6019072 / (pi * 0.5651591)) ** 2), rel=1e-5)
    assert by_rule(box, 400.0, 90.0)[1] < 1e-4 * 20.0 * UNIT


def test_within_its_range_the_rule_agrees_with_capytaine():
    """Head waves shorter than 0.8 lengths and beam waves shorter than two breadths, 25 %; at the resonance of heave it
    has a fifth of the force abeam, since nothing that the hull's own motion adds is in it."""
    box, table = hull_of("barge20").in_still_water(8.0, 1000.0, GRAVITY), read_table(BARGE)
    omega = np.array([2.0, 2.1, 2.2, 2.3, 2.4])
    for heading, number in ((180.0, 0), (90.0, 1)):
        waves_met = omega, omega**2 / GRAVITY, np.full(5, np.radians(heading))
        ratio = waterline_law(box)(*waves_met)[number] / table.coefficients(*waves_met)[number]
        assert np.abs(ratio - 1.0).max() < 0.25
    resonant = np.array([1.6]), np.array([1.6]) ** 2 / GRAVITY, np.radians([90.0])
    assert waterline_law(box)(*resonant)[1] < 0.25 * table.coefficients(*resonant)[1]


def test_a_table_is_linear_between_its_rows_and_mirrored_beyond_180_degrees(tmp_path):
    file = written(tmp_path, "1,0,8,0,0", "1,180,-8,0,0", "1,90,0,4,2", "2,0,0,0,0", "2,90,0,8,6", "2,180,-4,0,0")
    table = read_table(file)

    def found(omega: float, heading: float) -> list[float]:
        return table.coefficients(np.array([omega]), np.ones(1), np.radians([heading]))[:, 0].tolist()

    assert found(1.5, 135.0) == pytest.approx([-3.0, 3.0, 2.0])
    assert found(1.5, 225.0) == pytest.approx([-3.0, -3.0, -2.0])
    assert found(0.5, 90.0) == pytest.approx([0.0, 2.0, 1.0])  # nothing at 0 rad/s
    assert found(9.0, 90.0) == pytest.approx([0.0, 8.0, 6.0])


def written(folder, *rows: str, heading: str = ",".join(TABLE_COLUMNS)) -> str:
    (folder / "drift.csv").write_text("\n".join([heading, *rows]) + "\n")
    return str(folder / "drift.csv")


@pytest.mark.parametrize(
    "rows, names, wrong",
    [
        (["1,0,8,0,0"], "omega_rad_s,heading_deg,surge_N_m2,sway_N_m2", "1 names|5 cells under 4|no column"),
        (["1,0,8,0"], "omega_rad_s,heading_deg,surge_N_m2,sway_N_m2", "it has no column yaw_Nm_m2"),
        (["1,0,8,0,x"], None, "yaw_Nm_m2 is 'x' in row 1"),
        (["1,0,8,0,0", "0,0,8,0,0"], None, "row 2 has 0 rad/s and 0 degrees"),
        (["1,-90,8,0,0"], None, "row 1 has 1 rad/s and -90 degrees"),
        (["1,0,8,0,0", "2,90,0,8,0"], None, "2 rad/s and 0 degrees stand in 0 rows"),
        (["1,0,8,0,0", "1,0,8,0,0"], None, "1 rad/s and 0 degrees stand in 2 rows"),
        (["1,0,8,0,0"], None, "its headings are 0 degrees alone"),
        (["1,0,8,0,0", "1,90,0,0,0"], None, "its headings are 0 to 90 degrees alone"),
        (["1,0,8,0,0", "1,1.571,0,0,0", "1,3.142,-8,0,0"], None, r"0 to 3\.142 degrees: are they radians\?"),
        (["1,0,8,0,0", "1,90,0,0,0", "1,200,0,0,0"], None, "its headings are 0 to 200 degrees alone"),
    ],
)
def test_a_faulty_table_is_named_with_its_row_and_what_was_expected(tmp_path, rows, names, wrong):
    file = written(tmp_path, *rows, heading=names or ",".join(TABLE_COLUMNS))
    with pytest.raises(Unreadable, match=wrong) as error:
        read_table(file)
    assert "drift.csv" in str(error.value)
    with pytest.raises(SceneError, match=r"ship\.drift"):
        load(scene({"drift": {"table": file}}))


def scene(ship: dict, fluid: dict | None = None) -> dict:
    """The barge, with four cubes over her draught, in waves."""
    return {
        "duration": 10.0,
        "basin": {"length": 400.0, "width": 400.0, "depth": 200.0, "walls": "none"},
        "fluid": {"kind": "linear_waves", "height": 0.2, "period": 3.5, "heading_deg": 90.0} | (fluid or {}),
        "ship": {"kind": "dynamic", "hull": "barge20", "cells_per_draught": 4.0} | ship,
        "time_step": {"kind": "fixed", "dt": 0.05},
        "runtime": {"precision": "f64", "threads": 1},
    }


def settled(drift: dict | None, free: tuple[str, ...] = ("sway",), period: float = 3.5) -> float:
    """Mean force [N] of springs that hold the barge in sway, after sixty waves with an amplitude of 0.1 m."""
    spring = {"from": [0.0, 2.5, 0.0], "stiffness": 2.0e4, "damping": 3.0e4, "slack_length": 80.0}
    lines = [spring | {"to": [side, 0.5, 0.0]} for side in (100.0, -100.0)]
    keys = scene({"free": list(free), "moorings": lines, "drift": drift}, {"period": period})
    with Simulation(load_without_observers(keys)) as simulation:
        places = []
        while simulation.time < 60.0 * period:
            simulation.step()
            places.append(simulation.ship.body.position[0])
    return 4.0e4 * float(np.mean(places[-int(20 * period / 0.05) :]))


def test_a_moored_hull_settles_at_force_over_stiffness():
    """Within 1 %; without the key by 4 % of that, the mean of first-order forces that follow her motion."""
    omega = np.array([2.0 * pi / 3.5])
    force = read_table(BARGE).coefficients(omega, omega**2 / GRAVITY, np.radians([90.0]))[1, 0] * 0.1**2
    assert settled({"table": BARGE}) == pytest.approx(force, rel=0.01)
    assert abs(settled(None)) < 0.05 * force


def test_with_the_key_first_order_forces_have_no_mean_of_their_own(tmp_path):
    """Under a table of zeros, at the resonance of heave; without the key that mean is nearly what a wall feels."""
    nothing = {"table": written(tmp_path, "1,0,0,0,0", "1,180,0,0,0")}
    wall, free, period = 0.1**2 * 20.0 * UNIT, ("sway", "heave", "roll"), 2.0 * pi / 1.5
    assert abs(settled(nothing, free, period)) < 0.02 * wall
    assert settled(None, free, period) > 0.7 * wall


def held_in(tmp_path, fluid: dict, drift="rule", until: float = 60.0) -> tuple[np.ndarray, np.ndarray, Simulation]:
    """Times (n,) [s], drift force to port (n,) [N] on the barge, held, and the simulation, which has ended."""
    keys = scene({"free": ["heave"], "drift": drift}, fluid | {"ramp": 0.0})
    if fluid["kind"] == "spectral_sea":
        keys["fluid"] = {key: value for key, value in keys["fluid"].items() if key in {*fluid, "ramp"}}
    times, forces = [], []
    with Simulation(load_without_observers(keys)) as simulation:
        while simulation.time < until:
            times.append(simulation.time)
            simulation.step()
            ship = floating_ship(simulation)
            forces.append(ship.last.parts[ship.parts.index("drift"), 0, 0])
    return np.array(times), np.array(forces), simulation


def test_two_waves_drift_a_hull_at_the_difference_of_their_frequencies(tmp_path):
    """Newman: a1^2 D1 + a2^2 D2, and a1 a2 (D1 + D2) at the difference, within 1 %; nothing at the waves' own
    frequencies or at their sum, where the first order alone acts."""
    amplitude, period = np.array([0.1, 0.15]), np.array([3.5, 4.0])
    rows = "\n".join(f"{a},{t},90,{30 * n}" for n, (a, t) in enumerate(zip(amplitude, period)))
    (tmp_path / "two.csv").write_text(f"amplitude_m,period_s,heading_deg,phase_deg\n{rows}\n")
    fluid = {"kind": "spectral_sea", "tile": 100.0, "cells": 16, "components": str(tmp_path / "two.csv")}
    times, force, _ = held_in(tmp_path, fluid, {"table": BARGE}, until=28.0 * 6.0)
    times, force = times[times >= 56.0], force[times >= 56.0]  # when she has forgotten her first velocity
    omega = 2.0 * pi / period
    d = read_table(BARGE).coefficients(omega, omega**2 / GRAVITY, np.radians([90.0, 90.0]))[1]
    slow = omega[0] - omega[1]
    wanted = (amplitude**2 * d).sum() + amplitude.prod() * d.sum() * np.cos(slow * times + pi / 6.0)
    assert np.abs(force - wanted).max() < 0.01 * amplitude.prod() * d.sum()

    def part(at: float) -> float:
        return abs(2.0 * np.mean((force - force.mean()) * np.exp(1j * at * times)))

    assert part(slow) == pytest.approx(amplitude.prod() * d.sum(), rel=0.01)
    assert max(part(at) for at in (*omega, omega.sum())) < 0.01 * part(slow)


def test_drift_is_the_same_in_both_seas_and_varies_in_random_ones_alone(tmp_path):
    regular = {"height": 0.2, "period": 3.5, "heading_deg": 90.0}
    _, one, _ = held_in(tmp_path, {"kind": "linear_waves", **regular}, until=5.0)
    _, other, _ = held_in(tmp_path, {"kind": "spectral_sea", "cells": 16, **regular}, until=5.0)
    _, steep, _ = held_in(tmp_path, {"kind": "spectral_sea", "cells": 32, "order": 3, **regular}, until=5.0)
    np.testing.assert_allclose(other, one, rtol=1e-9)
    np.testing.assert_allclose(steep, one, rtol=0.02)
    assert np.ptp(one) < 1e-9 * one.mean()
    random = {"kind": "spectral_sea", "cells": 16, "spectrum": {"significant_wave_height": 0.4, "peak_period": 3.5}}
    random["spectrum"]["heading_deg"] = 90.0
    _, force, ended = held_in(tmp_path, random, until=60.0)
    assert force.std() > 0.3 * force.mean() > 0.0
    sea = ended.fluid.plane_waves
    law = waterline_law(floating_ship(ended).hydrostatics)
    mean = (sea.amplitude**2 * law(sea.omega, sea.wavenumber, np.full(len(sea.omega), pi / 2.0))[1]).sum()
    assert force.mean() == pytest.approx(mean, rel=0.3)  # of some twenty waves


def test_the_slow_place_follows_a_ship_under_way_without_her_swing():
    law, sea = (lambda omega, k, heading: np.zeros((3, len(k)))), None
    body = hull_body(0.0, 3.0)
    drift = Drift(law, sea, body)
    drift.rate, omega = SLOW_SHARE * 1.5, 1.5
    for t in np.arange(0.0, 120.0, 0.02):
        drift.follow(hull_body(3.0 * t + np.sin(omega * t), 3.0 + omega * np.cos(omega * t)), 0.02)
        if t > 80.0:
            assert abs(drift.slow[0, 2] - 3.0 * (t + 0.02)) < 0.05


def hull_body(z: float, speed: float) -> RigidBody:
    turn = euler_quaternion(0.0, 0.0, 0.0)
    return RigidBody(1.0, np.eye(3), np.array([0.0, 0.0, z]), turn, np.array([0.0, 0.0, speed]), np.zeros(3))


def acting(ship: dict, fluid: dict | None = None, **keys) -> str:
    said = preflight(load(scene(ship, fluid) | keys))["statements"]
    return next((sentence for sentence in said if "act in these waves" in sentence), "")


def test_check_says_what_acts_on_each_ship():
    still = "on the ship act in these waves: no mean, no slow drift (first-order waves, drag and her motion alone"
    assert acting({}).startswith(still) and acting({}).endswith("no wind, no current")
    assert "mean, no slow drift (by rule)" in acting({"drift": "rule"})
    random = {"height": None, "period": None, "heading_deg": None}
    random |= {"spectrum": {"significant_wave_height": 0.4, "peak_period": 3.5}}
    found = acting({"drift": {"table": BARGE}}, random, wind={"kind": "stress", "u10": 8.0})
    assert found.endswith("mean, slow drift (by a table of waves of 2.62 to 15.7 s), wind, no current")
    found = acting({"drift": "rule"}, {"kind": "spectral_sea", "current": [0.5, 0.0]})
    assert found.endswith("mean, no slow drift (by rule), no wind, current")
    assert acting({"drift": "rule"}, {"height": 0.0}) == ""


@pytest.mark.parametrize("kind", ["linear_waves", "spectral_sea"])
@pytest.mark.parametrize(("period", "share"), [(3.5, None), (1.0, 100), (60.0, 100)])
def test_waves_beyond_the_table_are_warned_of(kind, period, share):
    waves = {"kind": kind, "period": period, "height": 0.05}
    said = load(scene({"drift": {"table": BARGE}}, waves)).warnings()
    found = [sentence for sentence in said if "beyond the table of drift" in sentence]
    assert [sentence.split(" %")[0] for sentence in found] == ([] if share is None else [f"{share}"])
    assert not [sentence for sentence in load(scene({"drift": "rule"}, waves)).warnings() if "drift" in sentence]


def test_a_table_all_round_is_closed(tmp_path):
    """From 350 to 10 degrees as between any others; a table of 20 to 340 degrees, too."""
    rows = [f"1,{heading},{np.cos(np.radians(heading))},{heading},0" for heading in range(0, 360, 20)]
    found = read_table(written(tmp_path, *rows)).coefficients(np.ones(2), np.ones(2), np.radians([350.0, 10.0]))
    assert found[0] == pytest.approx(0.5 + 0.5 * np.cos(np.radians(20.0))) and found[1] == pytest.approx([170.0, 10.0])


def test_on_particles_the_key_is_refused():
    tank = {"basin": {"length": 40.0, "width": 20.0, "depth": 6.0}, "fluid": {"kind": "delta_sph", "spacing": 1.0}}
    tank |= {"surface": {"kind": "marching_cubes"}, "time_step": {"kind": "courant"}}
    with pytest.raises(SceneError, match="particles carry the waves that drift her"):
        load(scene({"drift": "rule"}) | tank)


def test_without_the_key_its_module_is_not_imported():
    code = (
        "import sys; from ocean_sim.simulation import Simulation; from ocean_sim.reading.scene import load\n"
        f"config = load({scene({})!r})\n"
        "config.ships['ship'].in_still_water(9.81, 1000.0)\n"
        "sys.exit('ocean_sim.ship.forces.drift' in sys.modules or 'ocean_sim.ship.dynamic' not in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_capytaine_gives_the_table_of_the_barge():
    """On a mesh of a third of the panels within 5 % of the force on a wall."""
    pytest.importorskip("capytaine", reason="Capytaine is absent: pip install .[peers]")
    from benchmarks.drift_table import barge, drift_rows

    _, *rows = drift_rows(barge((20, 8, 4)), (1.8, 2.0), (90.0, 180.0))
    table = read_table(BARGE)
    for omega, heading, surge, sway, _ in (map(float, row.split(",")) for row in rows):
        known = table.coefficients(np.array([omega]), np.ones(1), np.radians([heading]))[:2, 0]
        assert [surge, sway] == pytest.approx(known, abs=0.05 * UNIT * 8.0)
