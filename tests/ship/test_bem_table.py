"""Tables of a panel method: what Capytaine wrote is read without it, and scattered waves push as its numbers say."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import Simulation, load
from ocean_sim.files.csv_file import read_columns
from ocean_sim.files.input_file import Unreadable
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.fluid import Arriving
from ocean_sim.ship.forces.radiation import MIRROR_SIGNS, Memory, Scattering, checked_table, read_bem_table
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.validation.shared.ship import (
    ImposedMotion,
    at_sea,
    first_harmonics,
    floating_ship,
    follow_body,
    impose_motion,
)
from ocean_sim.validation.shared.tables import table_path
from tests.conftest import quickly

BARGE = Path(__file__).parent / "data" / "barge20_capytaine.nc"  # by Capytaine 3.0.0, 24 x 10 x 3 panels
MOTIONS = ("sway", "heave", "surge", "pitch", "yaw", "roll")


def test_a_file_of_capytaine_gives_what_the_table_of_a_finer_mesh_does():
    found, finer = read_bem_table(str(BARGE)), read_columns(table_path("barge20_radiation"))
    assert tuple(found.motions) == MOTIONS and found.scattered is not None
    for name, unit in (("heave", "kg"), ("pitch", "kg_m2")):
        k = found.motions.index(name)
        both = (found.omega >= finer["omega_rad_s"][0]) & (found.omega <= finer["omega_rad_s"][-1])
        added = np.interp(found.omega[both], finer["omega_rad_s"], finer[f"{name}_added_{unit}"])
        np.testing.assert_allclose(found.added[k, k, both], added, rtol=0.05)
        damping = np.interp(found.omega[both], finer["omega_rad_s"], finer[f"{name}_damping_{unit}_s"])
        np.testing.assert_allclose(found.damping[k, k, both], damping, atol=0.05 * damping.max())
    assert checked_table(str(BARGE)).numbers == list(range(6))


def test_scattered_waves_of_a_port_and_a_starboard_sea_are_mirrored():
    """In Capytaine's own words too: waves to 45 and to 315 degrees."""
    scattering = Scattering(read_bem_table(str(BARGE)))
    omega = np.array([0.9, 1.3])
    port, starboard = (scattering.unit_wave_forces(omega, np.full(2, angle)) for angle in (45.0, 315.0))
    np.testing.assert_allclose(starboard, MIRROR_SIGNS[:, None] * port)
    assert np.abs(port[0]).max() > 1e4  # the mirror has something to turn


def test_the_push_turns_with_the_ship():
    """The same sea from the same side of a ship that heads elsewhere."""
    scattering = Scattering(read_bem_table(str(BARGE)))
    one = np.array([1.0])
    towards = Arriving(one, 0.7 * one, 1.2 * one, np.radians([30.0]), 0.147 * one)
    turned = Arriving(one, 0.7 * one, 1.2 * one, np.radians([120.0]), 0.147 * one)
    ahead = scattering.load(towards, 0.0, np.array([0.5, 0.0, 2.0]))
    aside = Scattering(read_bem_table(str(BARGE))).load(turned, np.pi / 2.0, np.array([2.0, 0.0, -0.5]))
    np.testing.assert_allclose(aside[:, [2, 1, 0]], ahead[:, [0, 1, 2]] * [-1.0, 1.0, 1.0], atol=1e-6)


def test_scattered_waves_push_a_hull_at_rest_as_the_table_says():
    scattering, one = Scattering(read_bem_table(str(BARGE))), np.array([1.0])
    waves = Arriving(0.3 * one, 0.7 * one, 1.2 * one, np.radians([30.0]), 0.147 * one)
    expected = (scattering.unit_wave_forces(1.2 * one, 30.0 * one)[:, 0] * 0.3 * np.exp(0.7j)).real
    np.testing.assert_allclose(scattering.load(waves, 0.0, np.zeros(3)).ravel(), expected, rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("heading", quickly(180.0, 0.0))
def test_under_way_in_long_waves_scattering_is_what_the_water_that_a_hull_displaces_would_have_done(heading):
    """The table of scattered waves against the motion of hull and water relative to each other, at 3 m/s in waves five
    times as long as the hull: heave and pitch within 6 %."""
    answers = [towed(str(table), 3.0, 8.0, heading) for table in (BARGE, table_path("barge20_radiation"))]
    np.testing.assert_allclose(*answers, rtol=0.06)


def towed(table: str, speed: float, period: float, heading: float) -> np.ndarray:
    """Heave and pitch [m], [rad] of the barge that is towed at a speed [m/s]."""
    ship = {"kind": "dynamic", "hull": "barge20", "radiation": table, "free": ["surge", "heave", "pitch"]}
    ship["velocity"] = [0.0, 0.0, speed]
    scene = at_sea(ship, 20.0, 0.08, 9.0 * period, height=0.1, period=period, heading_deg=heading)
    omega, rows = 2.0 * pi / period, []
    met = omega - omega**2 / 9.81 * speed * np.cos(np.radians(heading))
    with Simulation(load(scene)) as simulation:
        for time, body in follow_body(simulation, 9.0 * period):
            impose_motion(simulation, 2, ImposedMotion(speed * time, speed, 0.0))
            rows.append((time, body.position[1], body.angles[0]))
    times, *moved = np.array(rows).T
    last = times > 5.0 * period
    return first_harmonics(times[last], np.stack(moved, axis=1)[last], met)


def test_a_ship_takes_the_file_and_one_of_no_use_is_refused(tmp_path):
    scene = at_sea({"kind": "dynamic", "hull": "barge20", "radiation": str(BARGE)}, 20.0, 0.05, height=0.2, period=6.0)
    with Simulation(load(scene | {"duration": 0.2, "frames": None, "render": None, "motion": None})) as simulation:
        ship = floating_ship(simulation)
        simulation.step()
        assert np.isfinite(ship.last.parts).all() and not ship.through.any()
    wrong = tmp_path / "x.nc"
    wrong.write_bytes(b"CDF\x01 something")
    with pytest.raises(Unreadable, match="a NetCDF file is Capytaine's"):
        read_bem_table(str(wrong))


def test_capytaine_itself_writes_what_is_read(tmp_path):
    cpt = pytest.importorskip("capytaine", reason="Capytaine is absent: pip install .[peers]")
    pytest.importorskip("netCDF4")
    xarray = pytest.importorskip("xarray")
    mesh = cpt.mesh_parallelepiped(size=(20.0, 8.0, 4.0), resolution=(6, 4, 2)).immersed_part()
    body = cpt.FloatingBody(mesh=mesh, dofs=cpt.rigid_body_dofs(rotation_center=(0.0, 0.0, 0.5)), name="barge20")
    asked = {"omega": [1.2, 0.8], "wave_direction": [0.0, np.pi], "radiating_dof": list(body.dofs)}
    found = cpt.BEMSolver().fill_dataset(xarray.Dataset(coords=asked), body)
    cpt.export_dataset(str(tmp_path / "a.nc"), found)
    table = read_bem_table(str(tmp_path / "a.nc"))
    assert table.omega.tolist() == [0.8, 1.2] and table.scattered is not None
    exact = float(found.added_mass.sel(omega=0.8, radiating_dof="Heave", influenced_dof="Heave"))
    assert table.added[1, 1, 0] == pytest.approx(exact)
    two = [
        found.added_mass.sel(omega=0.8, radiating_dof=a, influenced_dof=b)
        for a, b in (("Sway", "Roll"), ("Roll", "Sway"))
    ]
    assert table.added[0, 5, 0] == table.added[5, 0, 0] == pytest.approx(0.5 * (float(two[0]) + float(two[1])))
    assert table.depth == np.inf and table.axis == pytest.approx(0.5)
    push = complex(found.diffraction_force.sel(omega=1.2, wave_direction=np.pi, influenced_dof="Pitch"))
    assert table.scattered.force[3, 1, 1] == pytest.approx(push)


def test_what_one_motion_does_to_another_comes_back_out_of_the_memory():
    """Of sway and roll, and of surge and pitch, as of each alone; the hull is alike on both sides and at both ends."""
    found = checked_table(str(BARGE))
    t, kernels, omega = found.impulse_response.times, found.impulse_response.kernels, found.omega
    for i, j in ((0, 5), (2, 3)):
        cosines = np.trapezoid(kernels[i, j] * np.cos(omega[:, None] * t), t, axis=1)
        sines = np.trapezoid(kernels[i, j] * np.sin(omega[:, None] * t), t, axis=1)
        given = found.damping[i, j]
        np.testing.assert_allclose(cosines, given, atol=0.05 * np.abs(given).max())
        added = found.added[i, j]
        np.testing.assert_allclose(
            found.impulse_response.added[i, j] - sines / omega, added, atol=0.05 * np.abs(added).max()
        )
    alone = {(i, j) for i, j in Memory(found).pairs if i != j}
    assert alone == {(0, 5), (5, 0), (2, 3), (3, 2)}


@pytest.mark.parametrize("free", [["roll"], ["sway", "roll"]])
def test_a_motion_that_is_held_takes_no_part_in_the_acceleration_of_another(free):
    """Heeled by 2 degrees and let go: roll alone turns by its torque over I + A66, beside a sway that is free by
    (M + A)^-1 of both."""
    ship = {"kind": "dynamic", "hull": "barge20", "radiation": str(BARGE), "free": free}
    scene = at_sea(ship | {"attitude_deg": [0.0, 0.0, 2.0]}, 20.0, 0.001)
    with Simulation(load(scene | {"frames": None, "render": None, "motion": None})) as simulation:
        barge = floating_ship(simulation)
        barge.between *= 10.0  # of a hull whose shape does so; of a barge it is next to nothing
        added, between, mass = barge.added, barge.between, barge.body.mass
        simulation.step()
        parts = barge.last.parts.sum(axis=0) - barge.last.parts[list(barge.parts).index("damping")]
    whole = np.array([[mass + added[0], between[0, 5]], [between[5, 0], barge.body.inertia_body[2, 2] + added[5]]])
    push = np.array([0.0, parts[1, 2]])
    right = push[1] / whole[1, 1] if free == ["roll"] else np.linalg.solve(whole, push)[1]
    assert barge.turning[2] == pytest.approx(right, rel=0.01)
    assert push[1] / whole[1, 1] != pytest.approx(np.linalg.solve(whole, push)[1], rel=0.02)


def test_a_table_in_words_gives_what_two_motions_do_to_each_other(tmp_path):
    rows = np.linspace(0.2, 4.0, 12)
    damping = np.exp(-((rows - 1.0) ** 2) * 4.0)
    names = ("sway_{}_kg{}", "roll_{}_kg_m2{}", "sway_roll_{}_kg_m{}")
    heads = [name.format(*what) for name in names for what in (("added", ""), ("damping", "_s"))]
    table = np.stack([rows, *(f * x for f in (2.0, 3.0, -1.0) for x in (np.ones(12), damping))], axis=1)
    path = tmp_path / "two.csv"
    np.savetxt(path, table, delimiter=",", header=",".join(["omega_rad_s", *heads]), comments="")
    found = read_bem_table(str(path))
    np.testing.assert_array_equal(found.damping[:, :, 3], damping[3] * np.array([[2.0, -1.0], [-1.0, 3.0]]))
    path.write_text(path.read_text().replace("sway_roll_damping_kg_m_s", "x"))
    with pytest.raises(ValueError, match="has no column sway_roll_damping_kg_m_s"):
        read_bem_table(str(path))


def in_the_frequency_domain(omega: float, extra: float) -> np.ndarray:
    """(3,) complex sway and heave over the amplitude, roll [rad/m], of the barge in a beam sea, by the file."""
    import h5py

    with h5py.File(BARGE) as data:
        names = [word.decode().lower() for word in data["influenced_dof"][:]]
        k, heading = (
            np.argmin(np.abs(data["omega"][:] - omega)),
            np.argmin(np.abs(data["wave_direction"][:] - np.pi / 2)),
        )
        at = [names.index(name) for name in ("sway", "heave", "roll")]
        mass, loss = (data[name][k][np.ix_(at, at)] for name in ("added_mass", "radiation_damping"))
        push = data["excitation_force"][:, k, heading][:, at]
    still = hull_of("barge20").in_still_water(8.0, 1000.0, 9.81)
    own = np.diag([still.matter.mass, still.inertia["heave"], still.inertia["roll"]])
    stiff = np.diag([0.0, still.stiffness["heave"], still.stiffness["roll"]])
    left = -(omega**2) * (own + mass) - 1j * omega * (loss + np.diag([0.0, 0.0, extra])) + stiff
    return np.linalg.solve(left, push[0] + 1j * push[1])


def in_the_time_domain(omega: float, together: bool) -> tuple[np.ndarray, float]:
    """The same from a run, and the damping of roll that it has besides waves."""
    ship = {"kind": "dynamic", "hull": "barge20", "radiation": str(BARGE), "free": ["sway", "heave", "roll"]}
    ship["damping"] = {"roll": 0.05, "cross_flow": 0.0}
    scene = at_sea(ship, 20.0, 0.05, height=0.04, period=2.0 * np.pi / omega, heading_deg=90.0)
    with Simulation(load(scene)) as simulation:
        body = floating_ship(simulation)
        if not together:
            body.between, body.memory.pairs = None, [[k, k] for k in range(6)]
        rows = []
        while simulation.time < 14.0 * 2.0 * np.pi / omega - 1e-9:
            height = simulation.fluid.elevations(np.zeros((1, 2)))[0]
            simulation.step()
            rows.append((height, *body.body.position[:2], body.body.angles[2]))
    period = round(2.0 * np.pi / omega / 0.05)
    rows = np.array(rows[-4 * period :])
    t = np.arange(len(rows)) * 0.05
    base = np.stack([np.cos(omega * t), np.sin(omega * t), np.ones_like(t), t], axis=1)
    fits = np.linalg.lstsq(base, rows, rcond=None)[0]
    height, *motions = fits[0] + 1j * fits[1]
    return np.array(motions) / height, float(body.resistance.linear["roll"])


@pytest.mark.slow
def test_a_barge_in_a_beam_sea_moves_as_the_coupled_table_says():
    """Sway, heave and roll by the file's six by six; without what sway and roll do to each other roll is another."""
    found, extra = in_the_time_domain(1.0, True)
    exact = in_the_frequency_domain(1.0, extra)
    np.testing.assert_allclose(np.abs(found), np.abs(exact), rtol=0.03)
    alone, _ = in_the_time_domain(1.0, False)
    assert abs(alone[2]) < 0.75 * abs(exact[2])


def test_a_table_of_the_same_depth_has_the_beds_part():
    ship = at_sea({"kind": "dynamic", "hull": "barge20", "radiation": str(BARGE)}, 20.0, 0.05)["ship"]
    config = load(at_sea(ship, 20.0, 0.05)).ships["ship"]
    config.__dict__["table"] = replace(config.table, depth=5.0)
    hull = config.in_still_water(9.81, 1000.0)
    assert config.shallow_water_warning(hull, 5.0) == "the water is 2.5 draughts deep: squat is not modelled"
    assert "the bed's part" in config.shallow_water_warning(hull, 6.0)


def test_check_says_where_a_table_is_of_another_case():
    ship = {"kind": "dynamic", "hull": "barge20", "radiation": str(BARGE), "velocity": [0.0, 0.0, 2.0]}
    ship["damping"] = {"roll": 0.02, "surge": 900.0}
    scene = at_sea(ship, 20.0, 0.05, height=0.2, period=6.0, ramp=0.0)
    assert ["without forward speed" in said for said in load(scene).warnings()] == [True]
    scene["basin"]["depth"] = 5.0
    still = dict(ship, velocity=[0.0, 0.0, 0.0], centre_of_mass=[0.0, 3.0, 0.0])
    shallow, deep, axis = sorted(load(scene | {"ship": still}).warnings(), reverse=True)
    assert shallow.startswith("the water is 2.5 draughts deep: squat")
    assert "added mass and damping" in shallow  # of deep water in the table
    assert "the table turns about a point 0.5 m over the still water, the centre of mass lies at 1 m" in deep
    assert "the table is of deep water, here it is 5 m" in axis and "shorter here" in axis


@pytest.mark.parametrize(("spacing", "words"), [(0.5, "would count them twice"), (-0.5, "spacing")])
def test_a_table_beside_particles_is_refused_and_a_wrong_fluid_told_as_such(spacing, words):
    """What is asked of other parts is asked when they could be read."""
    basin = {"length": 8.0, "width": 40.0, "depth": 4.0}
    fluid = {"kind": "mueller", "spacing": spacing}
    ship = {"kind": "dynamic", "hull": "barge20", "radiation": str(BARGE)}
    with pytest.raises(SceneError, match=words):
        load({"duration": 1.0, "basin": basin, "fluid": fluid, "surface": "cloth", "ship": ship})


def of_motions(folder: Path, columns: dict[str, np.ndarray | float], name: str = "table") -> str:
    """A table of added mass and damping that falls off, scaled by name of the columns."""
    omega = np.linspace(0.2, 4.0, 20)
    hump = np.exp(-((omega - 1.0) ** 2) * 2.0)
    rows = {"omega_rad_s": omega}
    for key, size in columns.items():
        rows[key] = size * (hump if "damping" in key else np.ones_like(omega))
    path = folder / f"{name}.csv"
    np.savetxt(path, np.stack(list(rows.values()), axis=1), delimiter=",", header=",".join(rows), comments="")
    return str(path)


SWAY = {"sway_added_kg": 2.0e5, "sway_damping_kg_s": 1.0e5}
HEAVE = {"heave_added_kg": 6.0e5, "heave_damping_kg_s": 3.0e5}
PITCH = {"pitch_added_kg_m2": 1.3e7, "pitch_damping_kg_m2_s": 4.0e6}
ROLL = {"roll_added_kg_m2": 1.2e6, "roll_damping_kg_m2_s": 2.0e5}
YAW = {"yaw_added_kg_m2": 5.0e6, "yaw_damping_kg_m2_s": 2.0e6}
SURGE = {"surge_added_kg": 5.0e4, "surge_damping_kg_s": 2.0e4}
TIED = {"sway_roll_added_kg_m": -1.0e5, "sway_roll_damping_kg_m_s": -5.0e4}


def said_of(folder: Path, columns: dict[str, float], hull: str = "barge20", **keys) -> str:
    ship = {"kind": "dynamic", "hull": hull, "cells_per_draught": 4.0, "radiation": of_motions(folder, columns)}
    ship |= {"damping": {"roll": 0.05, "surge": 500.0, "heave": 0.1, "pitch": 0.1}} | keys
    return "\n".join(load(at_sea(ship, 20.0, 0.05)).warnings())


@pytest.mark.parametrize(
    "columns, hull, missing",
    [
        (SWAY | ROLL, "barge20", "sway_roll_added_kg_m and sway_roll_damping_kg_m_s"),
        (SURGE | PITCH, "barge20", "surge_pitch_added_kg_m"),
        (HEAVE | PITCH, "yacht", "heave_pitch_added_kg_m"),
        (SWAY | YAW, "yacht", "sway_yaw_added_kg_m"),
        (ROLL | YAW, "yacht", "yaw_roll_added_kg_m2"),
        (HEAVE | SURGE, "yacht", "heave_surge_added_kg"),
        (HEAVE | PITCH, "barge20", ""),  # alike at both ends: nothing there
        (SWAY | ROLL | TIED, "barge20", ""),
        (HEAVE | ROLL, "yacht", ""),  # alike on both sides
    ],
)
def test_motions_of_a_table_that_do_nothing_to_each_other_are_said(tmp_path, columns, hull, missing):
    said = said_of(tmp_path, columns, hull)
    assert (missing in said) if missing else ("do to each other" not in said)
    assert "do to each other" not in said_of(
        tmp_path, columns, hull, free=["heave", "sway"]
    )  # of motions that are held


def test_a_pair_may_be_named_either_way_round_and_both_have_to_agree(tmp_path):
    turned = {key.replace("sway_roll", "roll_sway"): value for key, value in TIED.items()}
    one, other = (read_bem_table(of_motions(tmp_path, SWAY | ROLL | pair)) for pair in (TIED, turned))
    np.testing.assert_array_equal(one.added, other.added)
    np.testing.assert_array_equal(one.damping, other.damping)
    assert one.added[0, 1, 0] == one.added[1, 0, 0] == -1.0e5
    for wrong in ({key: -value for key, value in turned.items()}, dict.fromkeys(turned, 0.0)):
        with pytest.raises(ValueError, match="equal by reciprocity, and differs by"):
            read_bem_table(of_motions(tmp_path, SWAY | ROLL | TIED | wrong))


@pytest.mark.parametrize(
    "more, sentence",
    [
        ({"sway_roll_added_kg": 1.0}, "nothing reads the column sway_roll_added_kg"),
        ({"heave_damping_N_s_m": 1.0}, "nothing reads the column heave_damping_N_s_m"),
        ({"sway_scattered_90_re": 1.0}, "has no column sway_scattered_90_im"),
        ({"sway_roll_added_kg_m": 1.0}, "has no column sway_roll_damping_kg_m_s"),
    ],
)
def test_no_column_of_a_motion_is_dropped_without_a_word(tmp_path, more, sentence):
    with pytest.raises(ValueError, match=sentence):
        read_bem_table(of_motions(tmp_path, SWAY | ROLL | HEAVE | more))


@pytest.mark.parametrize(
    "columns, keys, sentence",
    [
        (ROLL, {"damping": {"roll": 0.0}}, "roll is damped by the waves of the table alone"),
        (ROLL, {"damping": {}}, "damping.ikeda: {} adds both by her form"),
        (HEAVE, {"damping": {"roll": 0.0}}, "roll is damped by the drag of what crosses her alone"),
        (HEAVE, {"damping": {"pitch": 0.0}}, "nothing damps pitch; damping.pitch does"),
        (SURGE, {"damping": {}}, "nothing but waves, which a steady speed does not make, holds her back in surge"),
        (HEAVE, {"damping": {"cross_flow": 0.0}}, "a steady drift in sway and yaw meets no drag"),
        (HEAVE | {"heave_added_kg": 5.0e8}, {}, "the natural period of heave"),
        (ROLL | {"roll_added_kg_m2": -2.0e5}, {}, "the added mass of quick motions (roll"),
        (SWAY | ROLL | {"sway_roll_added_kg_m": 0.0, "sway_roll_damping_kg_m_s": 9.0e5}, {}, "would give energy at"),
        (
            SWAY | ROLL | {f"sway_scattered_90_{part}": 1.0 for part in ("re", "im")},
            {},
            "not what they do in roll: no wave moves her there",
        ),
        (ROLL | {f"roll_scattered_90_{part}": 1.0 for part in ("re", "im")}, {}, "taken for those of any waves"),
    ],
)
def test_what_a_table_leaves_without_damping_mass_or_push_is_said(tmp_path, columns, keys, sentence):
    assert sentence in said_of(tmp_path, columns, **keys)
    held = {"free": ["heave"] if "heave" not in sentence and "heave_added_kg" not in columns else ["sway"]}
    if "energy" not in sentence and "quick" not in sentence and "any waves" not in sentence:
        assert sentence not in said_of(tmp_path, columns, **keys, **held)


def test_a_ship_whose_damping_is_complete_is_left_alone(tmp_path):
    said = said_of(tmp_path, SWAY | ROLL | TIED)
    assert "damp" not in said and "radiation" not in said
    for ikeda in ({"ikeda": {}}, {"roll_quadratic": 1.0e5}, {"roll": 0.03}):
        assert "roll is damped by" not in said_of(tmp_path, SWAY | ROLL | TIED, damping=ikeda)


def test_water_that_takes_more_mass_away_than_there_is_is_refused(tmp_path):
    with pytest.raises(SceneError, match="leaves her less than no mass"):
        said_of(tmp_path, ROLL | {"roll_added_kg_m2": -4.0e7})


def replaced(name, **how):
    """A change of a file of Capytaine: another data set under a name, or a link."""

    def change(data):
        import h5py

        del data[name]
        if "link" in how:
            data[name] = getattr(h5py, how["link"])(*how["to"])
        elif how.get("group"):
            data.create_group(name)
        else:
            data.create_dataset(name, **how)

    return change


def with_values(name, value):
    def change(data):
        data[name][...] = value

    return change


SPOILT = {
    "a size without end": (
        replaced("omega", shape=(10**13,), dtype="f8", chunks=(10**6,), compression="gzip"),
        "8e.07 MB",
    ),
    "a chunk without end": (
        replaced("omega", shape=(20,), maxshape=(None,), dtype="f8", chunks=(10**8,)),
        "omega unpacks",
    ),
    "names without end": (replaced("influenced_dof", shape=(3 * 10**8,), dtype="S5", chunks=(10**6,)), "1500 MB"),
    "a group": (replaced("omega", group=True), "no data set omega"),
    "words": (replaced("omega", data=["a", "b"]), "omega holds"),
    "complex numbers": (replaced("omega", data=np.ones(20, complex)), "omega holds"),
    "a compound": (replaced("omega", data=np.zeros(20, dtype=[("a", "f8")])), "omega holds"),
    "nothing": (replaced("omega", dtype="f8", shape=None), "no data set omega"),
    "a file elsewhere": (replaced("omega", link="ExternalLink", to=("/dev/zero", "/x")), "no data set omega"),
    "a link to itself": (replaced("omega", link="SoftLink", to=("/omega",)), "no data set omega"),
    "numbers elsewhere": (replaced("omega", shape=(20,), dtype="f8", external=[("/dev/zero", 0, 160)]), "another file"),
    "no axes": (replaced("added_mass", data=np.ones((20, 6, 6))), "missing or damaged"),
    "no number": (with_values("added_mass", np.nan), "not a finite number"),
    "the other sign": (with_values("radiation_damping", -1.0), "of the other sign"),
    "a frequency twice": (with_values("omega", 1.0), "rise, each once"),
    "an infinite frequency": (with_values("omega", np.inf), "not a finite number"),
}


@pytest.mark.parametrize("what", SPOILT)
def test_a_spoilt_file_of_a_panel_method_is_refused_in_a_sentence(tmp_path, what):
    import h5py

    change, said = SPOILT[what]
    file = tmp_path / "spoilt.nc"
    file.write_bytes(BARGE.read_bytes())
    with h5py.File(file, "r+") as data:
        change(data)
    with pytest.raises(Unreadable, match=said) as refused:
        checked_table(str(file))
    assert "\n" not in str(refused.value) and str(refused.value).isprintable()


def test_a_flipped_byte_of_a_panel_method_raises_nothing_else(tmp_path):
    rng, whole = np.random.default_rng(0), np.frombuffer(BARGE.read_bytes(), np.uint8)
    for _ in range(60):
        data = whole.copy()
        data[rng.integers(len(data), size=4)] = rng.integers(256, size=4)
        (tmp_path / "flipped.nc").write_bytes(data.tobytes())
        try:
            checked_table(str(tmp_path / "flipped.nc"))
        except Unreadable as error:
            assert str(error).isprintable()
