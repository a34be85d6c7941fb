"""Figure 6-4: how much of the sea is white under a wind: by the thesis's rule of height, by measurements at sea, and by
the convergence of crests; and seas with that much foam, from above: CSV and PNG.

The photograph of the thesis is not ours to show. The seas are fully developed (Pierson & Moskowitz 1964), their waves
scattered around the wind as cos^2. Foam lies where the water of crests converges most, on as much of the sea as
Monahan & O'Muircheartaigh (1980) saw white. The thesis's foam is height over 0.8 m, cut to 0 and 1, whatever the wind.

python figures/fig6_4.py [--fast] [--out DIR]
"""

from math import erf, exp, pi, sqrt
from pathlib import Path

import numpy as np
from _options import options, progress
from _paper import BLUE, GREY, INK, ORANGE, PALE, RED, keep, paper, table

from ocean_sim.conventions import GRAVITY
from ocean_sim.orbits import white_caps_of
from ocean_sim.random_numbers import numpy_uniform
from ocean_sim.waves import COMPONENTS, Spectrum, wavenumber

WINDS, SHOWN = np.arange(4.0, 25.0, 1.0), (7.0, 10.0, 15.0, 20.0)  # [m/s]
PHILLIPS, PEAK = 0.0081, 0.13  # of the spectrum; peak frequency times wind over g
FULL = 0.8  # [m] height at which the thesis's foam is whole
DEPTH, SIDE, POINTS = 500.0, 6.0, 512  # [m], [peak wavelengths], along a side
SHORTEST = 6.0  # [peak frequencies] of the waves that are drawn


def developed(wind: float) -> tuple[float, float]:
    """Significant height [m] and peak period [s]: 0.241 U^2/g and U/(0.13 g)."""
    period = wind / (PEAK * GRAVITY)
    return 4.0 * sqrt(PHILLIPS * GRAVITY**2 / 5.0) * (period / (2.0 * pi)) ** 2, period


def sea(wind: float, points: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places along a side [m], elevation (n, n) [m], and convergence of the crests (n, n): how much the water of the
    surface is pressed together where it is displaced as linear theory has it."""
    height, period = developed(wind)
    spectrum = Spectrum(kind="pierson_moskowitz", significant_wave_height=height, peak_period=period, cut_off=SHORTEST)
    waves = spectrum.components(np.array([1.0, 0.0]), DEPTH)
    amplitude, k, phase = waves.amplitude, waves.wavenumber, waves.phase
    n = np.arange(len(k))
    angle = spread(numpy_uniform(11, 0x4_0000, n, 0))
    side = SIDE * 2.0 * pi / float(wavenumber(2.0 * pi / period, DEPTH))
    along = (np.arange(points) + 0.5) / points * side - side / 2
    # a sum of plane waves is a product of what they do along x and along z
    x = np.exp(1j * np.outer(along, k * np.cos(angle)))
    z = np.exp(1j * np.outer(along, k * np.sin(angle)))
    carried = amplitude * np.exp(1j * phase)
    elevation = ((z * carried) @ x.T).real
    return along, elevation, ((z * (carried * k)) @ x.T).real


def spread(uniform: np.ndarray) -> np.ndarray:
    """Angles to the wind [rad], distributed as cos^2, of numbers spread evenly from 0 to 1."""
    angle = np.linspace(-pi / 2, pi / 2, 2001)
    return np.interp(uniform, 0.5 + (angle + np.sin(2.0 * angle) / 2.0) / pi, angle)


def by_height(elevation: np.ndarray) -> np.ndarray:
    """The thesis's foam (5.2.3), before its texture."""
    return np.clip(elevation / FULL, 0.0, 1.0)


def expected_by_height(height: float) -> float:
    """Its mean over a sea of normally distributed heights of this significant height [m]."""
    s = height / 4.0
    return s / (FULL * sqrt(2.0 * pi)) * (1.0 - exp(-((FULL / s) ** 2) / 2.0)) + 0.5 * (1.0 - erf(FULL / s / sqrt(2.0)))


def drawn(rows: list[tuple], seas: dict[float, tuple], path: Path) -> None:
    """Cover over wind; seas from above with their foam."""
    figure = paper(13.5, 7.6)
    grid = figure.add_gridspec(2, 4, height_ratios=(1.25, 1.0))
    axes = figure.add_subplot(grid[0, :])
    wind, _, _, wanted, cover, _, mean, expected = np.array(rows).T
    axes.semilogy(wind, 100 * expected, color=RED, lw=1.8, ls="--", label="thesis, height over 0.8 m: closed form")
    axes.semilogy(wind, 100 * mean, "s", color=RED, ms=5, mfc="none", label="thesis, mean over the sea")
    axes.semilogy(wind, 100 * wanted, color=BLUE, lw=2.0, label="Monahan & O'Muircheartaigh 1980")
    axes.semilogy(wind, 100 * cover, "o", color=ORANGE, ms=5, mec=INK, mew=0.5, label="crest convergence, as drawn")
    axes.set(xlabel="wind at 10 m, U10 [m/s]", ylabel="white part of the sea [%]", xlim=(3.5, 24.5), ylim=(0.03, 100))
    axes.set_yticks([0.1, 1.0, 10.0, 100.0], ["0.1", "1", "10", "100"])
    axes.grid(color=PALE, lw=0.7)
    axes.legend(loc="lower right", ncols=2)
    for column, (speed, (along, elevation, foam)) in enumerate(seas.items()):
        panel = figure.add_subplot(grid[1, column])
        height = developed(speed)[0]
        step = along[1] - along[0]
        down, across = np.gradient(elevation, step)
        light = np.clip(0.5 - 3.0 * (0.8 * across + 0.6 * down), 0.0, 1.0)[..., None]
        water = (1.0 - light) * np.array([0.02, 0.13, 0.23]) + light * np.array([0.36, 0.58, 0.68])
        picture = water + (np.array([0.97, 0.98, 0.98]) - water) * foam[..., None]
        ends = (along[0], along[-1], along[0], along[-1])
        panel.imshow(picture, origin="lower", extent=ends, interpolation="bilinear")
        panel.set_title(f"{speed:g} m/s, $H_s$ {height:.1f} m: {100 * foam.mean():.1f} %", fontsize=10)
        panel.set_xlabel("downwind [m]")
        if column == 0:
            panel.set_ylabel("across [m]")
        panel.tick_params(labelsize=8, color=GREY)
    keep(figure, path)


def main() -> None:
    asked = options(__doc__, "fewer points and winds")
    points = 128 if asked.fast else POINTS
    winds = sorted({*WINDS[:: 4 if asked.fast else 1].tolist(), *SHOWN})
    rows, seas = [], {}
    for done, wind in enumerate(winds):
        height, period = developed(wind)
        along, elevation, convergence = sea(wind, points)
        wanted = white_caps_of(wind)
        least = float(np.quantile(convergence, 1.0 - wanted))
        foam = (convergence > least).astype(float)
        mean = float(by_height(elevation).mean())
        rows.append((wind, height, period, wanted, float(foam.mean()), least, mean, expected_by_height(height)))
        if wind in SHOWN:
            seas[wind] = along, elevation, foam
        progress((done + 1) / len(winds), f"a sea under {wind:g} m/s")
    head = [f"fully developed seas of {COMPONENTS} waves, {points} x {points} points over six peak wavelengths"]
    head += ["foam where the convergence of crests is above `convergence`; thesis: height over 0.8 m, cut to 0 and 1"]
    columns = ["u10_m_s", "hm0_m", "tp_s", "measured_at_sea", "drawn", "convergence", "thesis", "thesis_closed_form"]
    table(asked.out / "fig6_4.csv", head, columns, rows)
    drawn(rows, seas, asked.out / "fig6_4.png")


if __name__ == "__main__":
    main()
