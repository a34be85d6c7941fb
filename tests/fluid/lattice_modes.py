"""Elastic modes of a lattice of particles under a kernel."""

from itertools import product

import numpy as np

from ocean_sim.fluid.sph.smoothing import Stencil


def softest_mode(stencil: Stencil) -> float:
    """Smallest eigenvalue of the lattice's elasticity under one pressure everywhere, over the typical largest. Where it
    is negative, still water does not stay on its lattice: rounding errors grow until it is none.

    Pairs then push each other along grad W, as atoms do that repel by a potential W, so these are the eigenvalues of
    the dynamical matrix of such a crystal (Born & Huang 1954, Dynamical Theory of Crystal Lattices) over those of a
    wave's 2 sum(1 - cos k), which leaves sound out.
    """
    x, along, across = stencil.lattice_bonds
    d = stencil.smoothing.dimension
    stiffness = ((along - across) / (x**2).sum(axis=1))[:, None, None] * x[:, :, None] * x[:, None, :]
    stiffness += across[:, None, None] * np.eye(d)
    waves = np.array([wave for wave in product(np.linspace(0.0, np.pi, 13), repeat=d) if any(wave)])
    matrices = np.einsum("kn,nij->kij", 1.0 - np.cos(waves @ x.T), stiffness)
    scaled = np.linalg.eigvalsh(matrices) / (1.0 - np.cos(waves)).sum(axis=1)[:, None]
    return float(scaled.min() / np.median(scaled[:, -1]))
