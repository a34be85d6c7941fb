"""The memory of radiated waves: what a table gives comes back out of it, and one with gaps is refused."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import Simulation, load
from ocean_sim.files.csv_file import read_columns
from ocean_sim.reading.scene import SceneError
from ocean_sim.ship.forces.damping import BY_RULE, Damping, Resistance
from ocean_sim.ship.forces.radiation import Memory, checked_table
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.validation.shared.ship import at_sea, follow_body, set_pose
from ocean_sim.validation.shared.tables import table_path

SPHERE, BARGE = table_path("sphere_radiation"), table_path("barge20_radiation")
HALF = 2.0 / 3.0 * pi * 1000.0 * 5.0**3  # [kg] of water that the sphere displaces


def test_a_hemisphere_that_heaves_at_once_takes_half_of_its_displacement_along():
    """Hulme 1982: A(infinity) is 1/2 in closed form; the table ends at K a = 10."""
    assert checked_table(str(SPHERE)).impulse_response.added[0, 0] == pytest.approx(0.5 * HALF, rel=0.005)


@pytest.mark.parametrize("file, motions", [(SPHERE, ["heave"]), (BARGE, ["heave", "pitch"])])
def test_what_the_table_gives_comes_back(file, motions):
    given, found = read_columns(file), checked_table(str(file)).impulse_response
    omega, t = given["omega_rad_s"], found.times
    for k, motion in enumerate(motions):
        unit = "kg" if motion == "heave" else "kg_m2"
        added, damping = given[f"{motion}_added_{unit}"], given[f"{motion}_damping_{unit}_s"]
        cosines = np.trapezoid(found.kernels[k, k] * np.cos(omega[:, None] * t), t, axis=1)
        sines = np.trapezoid(found.kernels[k, k] * np.sin(omega[:, None] * t), t, axis=1)
        np.testing.assert_allclose(cosines, damping, atol=0.03 * damping.max())
        np.testing.assert_allclose(found.added[k, k] - sines / omega, added, rtol=0.03)


def test_a_steady_oscillation_is_held_back_by_damping_and_carried_by_added_mass():
    """At one frequency the memory is -B v less (A - A(infinity)) times the acceleration, however steps fall."""
    omega = 1.2531  # K a = 0.8
    memory, random, time = Memory(checked_table(str(SPHERE))), np.random.default_rng(3), 0.0
    rows = []
    while time < 60.0:
        motion = np.zeros(6)
        motion[1] = np.cos(omega * time)
        if time > 45.0:
            rows.append((np.cos(omega * time), -omega * np.sin(omega * time), memory.load(time, motion)[0, 1]))
        memory.remember(time, motion)
        time += random.uniform(0.005, 0.04)
    speed, rate, force = np.array(rows).T
    (damping, added), *_ = np.linalg.lstsq(-np.stack([speed, rate], axis=1), force, rcond=None)
    given = read_columns(SPHERE)
    assert damping == pytest.approx(np.interp(omega, given["omega_rad_s"], given["heave_damping_kg_s"]), rel=0.03)
    exact = np.interp(omega, given["omega_rad_s"], given["heave_added_kg"])
    assert memory.impulse_response.added[0, 0] + added == pytest.approx(exact, rel=0.03)
    assert len(memory.when) * memory.often < memory.impulse_response.times[-1] + 3.0 * memory.often  # it forgets


def test_a_hull_that_pitches_under_way_feels_strip_theorys_terms_of_speed():
    """A35 = -U B33 / w^2, B55 = B55 + U^2 / w^2 B33 and so on (Salvesen, Tuck & Faltinsen 1970, table 1), less what
    A(infinity) does, which is not the memory's."""
    speed, omega, angle = 4.0, 1.1, 0.05
    found = checked_table(str(BARGE))
    memory, random, time, rows = Memory(found), np.random.default_rng(3), 0.0, []
    while time < 60.0:
        pitch, rate = angle * np.sin(omega * time), angle * omega * np.cos(omega * time)
        motion = np.array([0.0, speed * pitch, speed, rate, 0.0, 0.0])  # bow down: her own axes see her rise
        if time > 45.0:
            (_, heave, _), (twist, _, _) = memory.load(time, motion)
            rows.append((omega**2 * pitch, -rate, heave, twist))
        memory.remember(time, motion)
        time += random.uniform(0.005, 0.04)
    *two, heave, twist = np.array(rows).T
    (a35, b35), (a55, b55) = (np.linalg.lstsq(np.stack(two, axis=1), f, rcond=None)[0] for f in (heave, twist))
    at = {
        (what, k): np.interp(omega, found.omega, whole[k, k])
        for k in (0, 1)
        for what, whole in (("a", found.added - found.impulse_response.added[..., None]), ("b", found.damping))
    }
    over = speed / omega
    assert a35 == pytest.approx(-over / omega * at["b", 0], rel=0.03)
    assert b35 == pytest.approx(speed * at["a", 0], abs=0.01 * speed * found.added[0, 0].max())
    assert a55 == pytest.approx(at["a", 1] + over**2 * at["a", 0], abs=0.02 * found.added[1, 1].max())
    assert b55 == pytest.approx(at["b", 1] + over**2 * at["b", 0], rel=0.03)


def test_a_sphere_let_go_a_little_swings_as_linear_theory_says():
    """Extrema of the Cummins equation, solved in the frequency domain with Hulme's coefficients."""
    ship = {"kind": "dynamic", "hull": "sphere", "free": ["heave"], "radiation": str(SPHERE)}
    with Simulation(load(at_sea(ship, 10.0, 0.02))) as simulation:
        rest = simulation.ships["ship"].body.position.copy()
        set_pose(simulation, position=rest + [0.0, 0.05, 0.0])
        path = [(t, (b.position[1] - rest[1]) / 0.05) for t, b in follow_body(simulation, 7.0)]
    t, y = np.array(path).T
    for time, height in ((2.21, -0.8670), (4.42, 0.6349), (6.60, -0.4648)):
        near = np.abs(t - time) < 0.6
        k = np.argmax(np.abs(y[near]))
        assert y[near][k] == pytest.approx(height, abs=0.015)
        assert t[near][k] == pytest.approx(time, abs=0.06)


@pytest.mark.parametrize("changes", [{}, {"resolution": 1.001}])
def test_a_scene_that_is_written_out_and_read_again_has_the_same_damping(changes):
    """By rule, nothing is added to the motions of the table, however often a scene is read; what is given is."""
    ship = {"kind": "dynamic", "hull": "sphere", "radiation": str(SPHERE), "damping": {"roll": 0.07}}
    ship["cells_per_draught"] = 4
    first, paths = load(at_sea(ship, 10.0, 0.02)), []
    again = load(first.resolved(), changes)
    for scene in (first, again):
        with Simulation(scene) as simulation:
            linear, surge = simulation.ships["ship"].resistance.linear, simulation.ships["ship"].resistance.surge
            rest = simulation.ships["ship"].body.position.copy()
            set_pose(simulation, position=rest + [0.0, 0.5, 0.0])
            path = np.array([b.position for _, b in follow_body(simulation, 1.0)])
        assert linear["heave"] == 0.0 and linear["pitch"] > 0.0 and surge > 0.0
        paths.append((linear, surge, path))
    for one, other in zip(*paths):
        np.testing.assert_array_equal(one, other)


def test_damping_by_rule_of_a_motion_in_the_table_is_none_but_what_is_given_counts():
    hull = hull_of("sphere").in_still_water(4.0, 1000.0, 9.81)
    still, none = np.zeros(6), {"heave", "pitch", "roll", "surge"}
    ruled = Resistance(Damping(), hull, still)
    bare = Resistance(Damping(), hull, still, none)
    given = Resistance(Damping(heave=BY_RULE["heave"], surge=3.0), hull, still, none)
    assert set(bare.linear.values()) == {0.0} and bare.surge == 0.0
    assert given.linear["heave"] == ruled.linear["heave"] > 0.0 == given.linear["pitch"] and given.surge == 3.0


def changed(rows: list[str], what: str) -> list[str]:
    if what == "no damping":
        return [",".join(row.split(",")[:2]) for row in rows]
    if what == "not a number":
        return [*rows[:3], "0.9,much,3.0", *rows[4:]]
    if what == "frequencies fall":
        return [rows[0], *rows[:0:-1]]
    if what == "ends early":
        return rows[:6]
    if what == "no waves":
        return [rows[0], *(",".join([*row.split(",")[:2], "0"]) for row in rows[1:])]
    return ["a,b", "1,2", "2,3"]


@pytest.mark.parametrize(
    "what, sentence",
    [
        ("no damping", "has no column heave_damping_kg_s"),
        ("not a number", "heave_added_kg is 'much' in row 3"),
        ("frequencies fall", "4 to 300 frequencies above 0, which rise"),
        ("ends early", "that of heave still is 100% of its most; damping"),
        ("no waves", "that of heave lies between 0 and 0; damping is above 0"),
        ("another table", "has no column of added mass, such as heave_added_kg"),
    ],
)
def test_a_table_that_gives_too_little_is_refused(tmp_path: Path, what, sentence):
    rows = [line for line in SPHERE.read_text().splitlines() if not line.startswith("#")]
    file = tmp_path / "table.csv"
    file.write_text("\n".join(changed(rows, what)))
    scene = at_sea({"kind": "dynamic", "hull": "sphere", "radiation": str(file)}, 10.0, 0.02)
    with pytest.raises(SceneError, match=r"ship\.radiation") as refused:
        load(scene)
    assert sentence in str(refused.value)
