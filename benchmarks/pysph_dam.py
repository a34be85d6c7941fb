"""PySPH beside this program: a dam break under its WCSPH, with or without its density diffusion.

It compiles its kernels as it begins, into the `folder` of the order.
"""

import math
import os
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from benchmarks.another_python import Watch

PEER, PACKAGE = "PySPH", "pysph"
INSTALLED = "pysph setuptools"  # it imports distutils, which Python has no more
ENVIRONMENT: dict[str, str] = {}
DENSITY, GRAVITY = 1000.0, 9.81  # [kg/m3], [m/s2]
WALL_LAYERS = 2  # of particles in its walls, as in its own dam_break_3d


def main(order: dict[str, Any], watch: "Watch") -> None:
    """Run a dam break in a tank 2.5 times as long and 1.5 times as high as the water, which fills its width.

    As its own dam_break_3d, but for an integrator that evaluates forces once a step (its scheme's own, where the
    example evaluates them twice), and a speed of sound of 10 sqrt(|g| depth). Steps are fixed, and its adaptive ones
    where the order has an `end`. Viscosity is artificial: nu = alpha h c / 10.
    """
    import_module("compyle.ext_module")  # reads the user's options, which are at home
    os.environ |= dict.fromkeys(("HOME", "TMPDIR"), order["folder"])  # where it keeps what it compiles
    import numpy as np
    from pysph.base.kernels import WendlandQuintic  # type: ignore[import-not-found]
    from pysph.base.nnps_base import get_number_of_threads  # type: ignore[import-not-found]
    from pysph.base.utils import get_particle_array  # type: ignore[import-not-found]
    from pysph.solver.application import Application  # type: ignore[import-not-found]
    from pysph.sph.integrator import PECIntegrator  # type: ignore[import-not-found]
    from pysph.sph.scheme import WCSPHScheme  # type: ignore[import-not-found]

    if (threads := get_number_of_threads()) != order["threads"]:
        sys.exit(f"its OpenMP gives it {threads} threads, not {order['threads']}")
    spacing, lattice = order["spacing"], order["lattice"]
    kernel = WendlandQuintic(dim=3)
    length = order["support"] * spacing / kernel.radius_scale
    sound = 10.0 * math.sqrt(GRAVITY * lattice[1] * spacing)

    class DamBreak(Application):  # type: ignore[misc]
        def create_scheme(self) -> Any:
            return WCSPHScheme(
                ["water"],
                ["walls"],
                dim=3,
                rho0=DENSITY,
                c0=sound,
                h0=length,
                hdx=length / spacing,
                gy=-GRAVITY,
                alpha=10.0 * order["viscosity"] / (length * sound),
                hg_correction=True,
                delta_sph=order["method"] == "delta-sph",
            )

        def configure_scheme(self) -> None:
            self.scheme.configure_solver(
                kernel=kernel,
                integrator_cls=PECIntegrator,
                tf=1e9,
                dt=0.25 * length / (1.1 * sound),
                adaptive_timestep=order["end"] > 0.0,
            )

        def create_particles(self) -> list[Any]:
            tank = [5 * lattice[0] // 2, 3 * lattice[1] // 2, lattice[2]]
            above = [WALL_LAYERS, 0, WALL_LAYERS]
            rows = [np.arange(-WALL_LAYERS, n + more) for n, more in zip(tank, above)]
            cells = np.stack(np.meshgrid(*rows, indexing="ij"), axis=-1).reshape(-1, 3)
            inside = ((cells >= 0) & (cells < tank)).all(axis=1)
            made = []
            for name, where in (("water", inside & (cells < lattice).all(axis=1)), ("walls", ~inside)):
                x, y, z = spacing * (cells[where].T + 0.5)
                mass = DENSITY * spacing**3
                made.append(get_particle_array(name=name, x=x, y=y, z=z, m=mass, h=length, rho=DENSITY))
            self.scheme.setup_properties(made)
            return made

    run = DamBreak(fname="dam_break", output_dir=order["folder"])
    try:
        run.setup(["--openmp", "--cache-nnps", "--disable-output", "--logfile", "", "--quiet"])
    except SystemExit:
        sys.exit("its kernels do not compile, which takes a C++ compiler with OpenMP, and Python's headers")
    water, walls = (array.get_number_of_particles() for array in run.particles)
    run.solver.add_pre_step_callback(lambda solver: watch.look(solver.t, water, walls))
    run.solver.solve(show_progress=False)
