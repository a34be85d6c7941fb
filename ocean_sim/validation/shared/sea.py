"""A tile of open sea: its scene, and waves on it."""

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.fluid.open_sea.wave_tile import Layer, Tile
from ocean_sim.simulation import Simulation

if TYPE_CHECKING:
    from ocean_sim.fluid.spectral_sea import SpectralSea

SPECTRAL_SCHEMES = ("spectral_sea",)


def tile_scene(side: float, cells: int, slice_: bool = False, depth: float = 500.0, **keys: Any) -> dict[str, Any]:
    """Scene of a tile of open sea, `side` [m] long with `cells` grid cells along it, of a `depth` [m]; 2-D if `slice_`.
    `keys`: further keys of the fluid; without them the sea is calm."""
    return {
        "duration": 1.0,
        "basin": {"length": side, "depth": depth, "walls": "none"} | ({} if slice_ else {"width": side}),
        "fluid": {"tile": side, "cells": cells, "ramp": 0.0} | keys,
        "runtime": {"precision": "f64"},
    }


def sea_of(simulation: Simulation) -> "SpectralSea":
    return cast("SpectralSea", simulation.fluid)


def nearest_image(tile: Tile, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Offsets x (cells, 1) and z (1, rows) [m] from a centre (2,) [m] to the nearest periodic image of each cell."""
    x, z = tile.nodes()
    dx, dz = x - centre[0], z - centre[1]
    return (dx - tile.side * np.round(dx / tile.side))[:, None], (dz - tile.width * np.round(dz / tile.width))[None, :]


def smooth_ramp(share: float) -> float:
    """Smooth step s^2 (3 - 2 s) for a `share` s: from 0 at 0 to 1 at 1 without a jump in slope, and 1 beyond."""
    part = min(1.0, share)
    return part**2 * (3.0 - 2.0 * part)


def travel_ahead(layer: Layer, eta: np.ndarray) -> None:
    """Make a layer's waves travel to +x: set elevation `eta` (cells, rows) [m], and the surface potential to it."""
    tile = layer.tile
    e, omega = tile.to_modes(eta), np.where(tile.omega > 0.0, tile.omega, np.inf)
    layer.eta = tile.to_values(e)
    layer.phi = tile.to_values(-1j * np.sign(tile.kx) * tile.gravity / omega * e)


def stokes_wave(steepness: float, k: float, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Stokes wave in deep water, to fifth order (Fenton 1985, J. Waterway 111): elevation [m] and surface potential
    [m2/s] at `x` (n,) [m], phase speed [m/s]. Its height is 2 steepness / k; `k`: wavenumber [1/m]; crest at 0."""
    s, angle = steepness, k * x
    first = s - 0.375 * s**3 - 422.0 / 384.0 * s**5
    second, third = 0.5 * s**2 + s**4 / 3.0, 0.375 * s**3 + 297.0 / 384.0 * s**5
    eta = first * np.cos(angle) + second * np.cos(2.0 * angle) + third * np.cos(3.0 * angle)
    eta += s**4 / 3.0 * np.cos(4.0 * angle) + 125.0 / 384.0 * s**5 * np.cos(5.0 * angle)
    phi = (s - 0.5 * s**3 - 37.0 / 24.0 * s**5) * np.exp(eta) * np.sin(angle)
    phi += 0.5 * s**4 * np.exp(2.0 * eta) * np.sin(2.0 * angle) + s**5 / 12.0 * np.exp(3.0 * eta) * np.sin(3.0 * angle)
    return eta / k, np.sqrt(GRAVITY / k**3) * phi, float(np.sqrt(GRAVITY / k) * (1.0 + 0.5 * s**2 + 0.125 * s**4))
