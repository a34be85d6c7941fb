"""Tables of drift forces for `ship.drift: {table: FILE}` from Capytaine 3.0, by its far-field formula (Maruo, Newman).

`python -m benchmarks.drift_table` prints that of `barge20`: ocean_sim/validation/data/barge20_drift.csv. For a hull of
your own, give `drift_rows` a floating body with mass, stiffness and six rigid motions about its centre of mass.
Capytaine's x points to the bow, y to port and z up, so its surge, sway and yaw are those of the table; a wave direction
of 180 degrees is a head sea in both.
"""

from collections.abc import Iterator
from math import pi, sqrt
from typing import Any

import numpy as np

HEADER = "omega_rad_s,heading_deg,surge_N_m2,sway_N_m2,yaw_Nm_m2"
FREQUENCIES = (0.4, 0.6, 0.8, 0.9, 1.0, 1.1, *np.arange(1.2, 2.01, 0.05), 2.1, 2.2, 2.3, 2.4)  # [rad/s]
HEADINGS = (0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0)  # [deg] to which waves go, from the bow
DENSITY, GRAVITY = 1000.0, 9.81  # [kg/m3], [m/s2]
ROLL_DAMPING = 0.05  # share of critical, besides that of waves


def barge(resolution: tuple[int, int, int]) -> Any:
    """Capytaine's `barge20`: 20 x 8 x 2 m, KG 2.5 m, radii of gyration 0.35 B, 0.25 L; `resolution`: panels on its
    sides."""
    import capytaine

    mesh = capytaine.mesh_parallelepiped(size=(20.0, 8.0, 4.0), resolution=resolution).immersed_part()
    centre, mass = (0.0, 0.0, 0.5), DENSITY * 20.0 * 8.0 * 2.0
    dofs = capytaine.rigid_body_dofs(rotation_center=centre)
    body = capytaine.FloatingBody(mesh=mesh, dofs=dofs, center_of_mass=centre)
    inertia = mass * np.diag([1.0, 1.0, 1.0, (0.35 * 8.0) ** 2, (0.25 * 20.0) ** 2, (0.25 * 20.0) ** 2])
    body.inertia_matrix = body.add_dofs_labels_to_matrix(inertia)
    body.hydrostatic_stiffness = body.compute_hydrostatic_stiffness(rho=DENSITY, g=GRAVITY)
    return body


def drift_rows(body: Any, frequencies: tuple[float, ...], headings: tuple[float, ...]) -> Iterator[str]:
    """Yield lines of a drift table of a Capytaine body: header, and a row for each frequency [rad/s] and heading
    [deg]."""
    import capytaine
    import xarray  # type: ignore[import-not-found]
    from capytaine.post_pro import rao
    from capytaine.post_pro.mean_drift_force import far_field_mean_drift_force

    theta = np.concatenate([[-0.02], np.linspace(0.0, 2.0 * pi, 361), [2.0 * pi + 0.02]])
    directions = np.radians(headings) + 1e-6  # none may lie at the border of theta
    water = {"rho": DENSITY, "g": GRAVITY, "water_depth": np.inf, "body": body}
    problems = [
        capytaine.RadiationProblem(radiating_dof=dof, omega=w, **water) for dof in body.dofs for w in frequencies
    ]
    problems += [
        capytaine.DiffractionProblem(wave_direction=beta, omega=w, **water) for beta in directions for w in frequencies
    ]
    results = capytaine.BEMSolver(method="indirect").solve_all(problems, keep_details=True, progress_bar=False)
    solved, far = capytaine.assemble_dataset(results), capytaine.io.xarray.kochin_data_array(results, theta)
    for each in (solved, far):
        for axis in ("radiating_dof", "influenced_dof"):
            if axis in each.coords:
                each[axis] = each[axis].astype(str)
    solved = xarray.merge([solved, far], join="outer", compat="no_conflicts")
    roll = {"influenced_dof": "Roll", "radiating_dof": "Roll"}
    stiff, own = (float(whole.sel(roll)) for whole in (body.hydrostatic_stiffness, body.inertia_matrix))
    heavy = own + float(solved["added_mass"].sel(roll).mean())
    lost = xarray.zeros_like(body.inertia_matrix)
    lost.loc[roll] = 2.0 * ROLL_DAMPING * sqrt(stiff * heavy)
    force = far_field_mean_drift_force(rao(solved, dissipation=lost), solved)
    yield HEADER
    for n, omega in enumerate(force["omega"].values):
        for h, beta in enumerate(force["wave_direction_k"].values):
            at = {"omega": n, "wave_direction_k": h, "wave_direction_l": h}
            values = [float(force[f"drift_force_{motion}"].isel(at).real) for motion in ("surge", "sway", "yaw")]
            yield ",".join(f"{value:.5g}" for value in (omega, round(np.degrees(beta), 3), *values))


if __name__ == "__main__":
    print("# Mean drift force of a barge of 20 x 8 x 2 m, KG 2.5 m, about its centre of mass, per amplitude squared,")
    print("# in deep water: Capytaine's far field (benchmarks/drift_table.py); roll with 5 % of critical damping more")
    print(*drift_rows(barge((30, 12, 6)), FREQUENCIES, HEADINGS), sep="\n")
