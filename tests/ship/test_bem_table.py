"""Tables of a panel method: what Capytaine wrote is read without it, and scattered waves push as its numbers say."""

from pathlib import Path

import numpy as np
import pytest

from ocean_sim import Simulation, load
from ocean_sim.files.csv_file import columns
from ocean_sim.files.input_file import Unreadable
from ocean_sim.fluid import Arriving
from ocean_sim.ship.shared.bem_table import ACROSS, Scattering, bem_table
from ocean_sim.ship.shared.radiation import Radiation
from ocean_sim.validation.shared.ship import at_sea, floating
from ocean_sim.validation.shared.tables import table_path

BARGE = Path(__file__).parent / "data" / "barge20_capytaine.nc"  # by Capytaine 3.0.0, 24 x 10 x 3 panels
MOTIONS = ("sway", "heave", "surge", "pitch", "yaw", "roll")


def test_a_file_of_capytaine_gives_what_the_table_of_a_finer_mesh_does():
    found, finer = bem_table(str(BARGE)), columns(table_path("barge20_radiation"))
    assert tuple(found.motions) == MOTIONS and found.scattered is not None
    for name, unit in (("heave", "kg"), ("pitch", "kg_m2")):
        k = found.motions.index(name)
        both = (found.omega >= finer["omega_rad_s"][0]) & (found.omega <= finer["omega_rad_s"][-1])
        added = np.interp(found.omega[both], finer["omega_rad_s"], finer[f"{name}_added_{unit}"])
        np.testing.assert_allclose(found.added[k, both], added, rtol=0.05)
        damping = np.interp(found.omega[both], finer["omega_rad_s"], finer[f"{name}_damping_{unit}_s"])
        np.testing.assert_allclose(found.damping[k, both], damping, atol=0.05 * damping.max())
    assert Radiation(str(BARGE)).numbers == list(range(6))


def test_scattered_waves_of_a_port_and_a_starboard_sea_are_mirrored():
    """In Capytaine's own words too: waves to 45 and to 315 degrees."""
    scattering = Scattering(bem_table(str(BARGE)))
    omega = np.array([0.9, 1.3])
    port, starboard = (scattering.forces(omega, np.full(2, angle)) for angle in (45.0, 315.0))
    np.testing.assert_allclose(starboard, ACROSS[:, None] * port)
    assert np.abs(port[0]).max() > 1e4  # the mirror has something to turn


def test_the_push_turns_with_the_ship():
    """The same sea from the same side of a ship that heads elsewhere."""
    scattering = Scattering(bem_table(str(BARGE)))
    one = np.array([1.0])
    towards = Arriving(one, 0.7 * one, 1.2 * one, np.radians([30.0]))
    turned = Arriving(one, 0.7 * one, 1.2 * one, np.radians([120.0]))
    ahead, aside = scattering.load(towards, 0.0), Scattering(bem_table(str(BARGE))).load(turned, np.pi / 2.0)
    np.testing.assert_allclose(aside[:, [2, 1, 0]], ahead[:, [0, 1, 2]] * [-1.0, 1.0, 1.0], atol=1e-6)


def test_a_ship_takes_the_file_and_one_of_no_use_is_refused(tmp_path):
    scene = at_sea({"kind": "dynamic", "hull": "barge20", "radiation": str(BARGE)}, 20.0, 0.05, height=0.2, period=6.0)
    with Simulation(load(scene | {"duration": 0.2, "frames": None, "render": None, "motion": None})) as simulation:
        ship = floating(simulation)
        simulation.step()
        assert np.isfinite(ship.last.parts).all() and not ship.through.any()
    wrong = tmp_path / "x.nc"
    wrong.write_bytes(b"CDF\x01 something")
    with pytest.raises(Unreadable, match="no NetCDF file of added mass and damping by Capytaine"):
        bem_table(str(wrong))


def test_capytaine_itself_writes_what_is_read(tmp_path):
    cpt = pytest.importorskip("capytaine")
    pytest.importorskip("netCDF4")
    xarray = pytest.importorskip("xarray")
    mesh = cpt.mesh_parallelepiped(size=(20.0, 8.0, 4.0), resolution=(6, 4, 2)).immersed_part()
    body = cpt.FloatingBody(mesh=mesh, dofs=cpt.rigid_body_dofs(rotation_center=(0.0, 0.0, 0.5)), name="barge20")
    asked = {"omega": [1.2, 0.8], "wave_direction": [0.0, np.pi], "radiating_dof": list(body.dofs)}
    found = cpt.BEMSolver().fill_dataset(xarray.Dataset(coords=asked), body)
    cpt.export_dataset(str(tmp_path / "a.nc"), found)
    table = bem_table(str(tmp_path / "a.nc"))
    assert table.omega.tolist() == [0.8, 1.2] and table.scattered is not None
    exact = float(found.added_mass.sel(omega=0.8, radiating_dof="Heave", influenced_dof="Heave"))
    assert table.added[1, 0] == pytest.approx(exact)
    push = complex(found.diffraction_force.sel(omega=1.2, wave_direction=np.pi, influenced_dof="Pitch"))
    assert table.scattered.force[3, 1, 1] == pytest.approx(push)
