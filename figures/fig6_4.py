"""Figure 6-4: how much of the sea is white under a wind: by the thesis's rule of height, by measurements at sea, and by
the convergence of crests; and seas with that much foam, from a mast: CSV and PNG.

The photograph of the thesis is not ours to show. The seas are fully developed (Pierson & Moskowitz 1964), their waves
scattered around the wind as cos^2. Foam lies where the water of crests converges most, on as much of the sea as
Monahan & O'Muircheartaigh (1980) saw white. A piece of a sea may have far more or less: each picture shows the moment,
of MOMENTS, at which the white share of its pixels is nearest to that of the sea. The thesis's foam is height over
0.8 m, cut to 0 and 1, whatever the wind.
fig6_4_bare.png shows the seas with nothing drawn but their waves: no far sea, ripples, foam or scattered sky.

python figures/fig6_4.py [--fast] [--out DIR]
"""

from dataclasses import replace
from math import erf, exp, pi, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from _kept import BARE, save_picture, take_pictures, view_rays, write_still_sea
from _options import options, progress
from _paper import BLUE, INK, ORANGE, PALE, RED, paper, save_figure, save_table

from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures.water.foam import gathering_noise, monahan_cover, white_shares
from ocean_sim.pictures.water.sea import GATHERING_LENGTH
from ocean_sim.random_numbers import numpy_uniform
from ocean_sim.waves import SPECTRUM_WAVES, Components, Spectrum, wavenumber

WINDS, SHOWN = np.arange(4.0, 25.0, 1.0), (7.0, 10.0, 15.0, 20.0)  # [m/s]
PHILLIPS, PEAK = 0.0081, 0.13  # of the spectrum; peak frequency times wind over g
FULL = 0.8  # [m] height at which the thesis's foam is whole
DEPTH, SIDE, POINTS = 500.0, 6.0, 512  # [m], [peak wavelengths], along a side
SHORTEST, SHORTEST_SEEN = 6.0, 10.0  # [peak frequencies] of the waves that are reckoned with, and drawn
PATCH, NODES = 240.0, 257  # [m] side of the sea on which the drawn foam is measured, and nodes along it
VIEW = {"camera": "fixed", "eye": (-43.6, 40.0, 61.0), "target": (0.0, -12.5, 0.0)}  # nothing in it is beyond PATCH
MOMENTS = np.arange(0.0, 30.0, 0.5)  # [s]


def developed(wind: float) -> tuple[float, float]:
    """Significant height [m] and peak period [s] of a fully developed sea: 0.241 U^2/g and U/(0.13 g), wind U [m/s]."""
    period = wind / (PEAK * GRAVITY)
    return 4.0 * sqrt(PHILLIPS * GRAVITY**2 / 5.0) * (period / (2.0 * pi)) ** 2, period


def spread_waves(wind: float, shortest: float) -> Components:
    """Waves of a fully developed sea, with directions scattered around +x; `shortest` [peak frequencies]: cut-off."""
    height, period = developed(wind)
    spectrum = Spectrum(kind="pierson_moskowitz", significant_wave_height=height, peak_period=period, cut_off=shortest)
    waves = spectrum.components(np.array([1.0, 0.0]), DEPTH)
    angle = cos2_angles(numpy_uniform(11, 0x4_0000, np.arange(len(waves.amplitude)), 0))
    vectors = waves.wavenumber[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Components(waves.amplitude, vectors, waves.phase, DEPTH)


def sea(wind: float, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Elevation (n, n) [m] of a sea, and convergence of its crests (n, n): minus the divergence of the surface's
    horizontal displacement, by linear theory."""
    waves = spread_waves(wind, SHORTEST)
    side = SIDE * 2.0 * pi / float(wavenumber(2.0 * pi / developed(wind)[1], DEPTH))
    return on_grid(waves, (np.arange(points) + 0.5) / points * side - side / 2)


def on_grid(waves: Components, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Elevation (n, n) [m] of waves at time 0 at places `along` x and along z (n,) [m], and convergence of crests."""
    # a sum of plane waves is a product of what they do along x and along z
    x, z = (np.exp(1j * np.outer(along, waves.wavevector[:, k])) for k in range(2))
    carried = waves.amplitude * np.exp(1j * waves.phase)
    return ((x * carried) @ z.T).real, ((x * (carried * waves.wavenumber)) @ z.T).real


def cos2_angles(uniform: np.ndarray) -> np.ndarray:
    """Angles to the wind [rad], distributed as cos^2, from numbers distributed evenly over 0 to 1."""
    angle = np.linspace(-pi / 2, pi / 2, 2001)
    return np.interp(uniform, 0.5 + (angle + np.sin(2.0 * angle) / 2.0) / pi, angle)


def foam_by_height(elevation: np.ndarray) -> np.ndarray:
    """Foam cover by the thesis's rule of height (5.2.3), without its texture."""
    return np.clip(elevation / FULL, 0.0, 1.0)


def mean_foam_by_height(height: float) -> float:
    """Mean of `foam_by_height` over a sea of normally distributed elevation and this significant height [m]."""
    s = height / 4.0
    return s / (FULL * sqrt(2.0 * pi)) * (1.0 - exp(-((FULL / s) ** 2) / 2.0)) + 0.5 * (1.0 - erf(FULL / s / sqrt(2.0)))


def white_in_view(waves: Components, cover: float) -> float:
    """White share of the pixels of VIEW when foam is on a share `cover` of PATCH."""
    from scipy.ndimage import map_coordinates

    nodes = np.linspace(-PATCH / 2, PATCH / 2, NODES)
    grain = gathering_noise(np.array(np.meshgrid(nodes, nodes, indexing="ij")).reshape(2, -1) / GATHERING_LENGTH)
    height, convergence = on_grid(waves, nodes)
    white = white_shares(convergence * grain.reshape(NODES, NODES), cover)
    eye, rays = view_rays(VIEW, 4 / 3, 36)
    along = np.linspace(0.5, 1.4, 120)[:, None, None]  # of the way to still water
    points = eye - along * eye[1] * rays / rays[:, 1:2]
    at = np.moveaxis((points[..., [0, 2]] / PATCH + 0.5) * (NODES - 1), -1, 0)
    met = np.argmax(points[..., 1] <= map_coordinates(height, at, order=1, mode="nearest"), axis=0)
    return float(map_coordinates(white, at[:, met, np.arange(len(rays))], order=1, mode="nearest").mean())


def typical_moment(wind: float, moments: np.ndarray) -> tuple[Components, float, float]:
    """Waves of a sea at that of some moments [s] at which the white share of the pixels is nearest to that of the sea;
    the moment [s] and the share."""
    waves, cover = spread_waves(wind, SHORTEST_SEEN), monahan_cover(wind)
    later = [replace(waves, phase=waves.phase - waves.omega * time) for time in moments]
    shares = np.array([white_in_view(sea, cover) for sea in later])
    best = int(np.abs(shares - cover).argmin())
    return later[best], float(moments[best]), float(shares[best])


def sea_pictures(seas: dict[float, Components], size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Pictures (n, height, width, 3) of seas by their winds, with their foam, and the same ones bare."""
    with TemporaryDirectory() as place:
        given: list[dict[str, Any]] = []
        for wind, waves in seas.items():
            folder = write_still_sea(waves, PATCH, Path(place, f"{wind:g}"))
            given.append({"folder": str(folder), "foam_cover": monahan_cover(wind)})
        view = VIEW | {"size": size, "quality": "draft" if size[0] < 500 else "final"}
        pictures = take_pictures(Path(given[0]["folder"]), 0.0, given + [one | BARE for one in given], **view)
    return pictures[: len(seas)], pictures[len(seas) :]


def draw_figure(rows: list[tuple], shares: dict[float, float], pictures: np.ndarray, path: Path) -> None:
    """Draw foam cover over wind speed, and the seas with their foam; `shares`: white shares of the pictures by wind."""
    figure = paper(13.5, 7.2)
    grid = figure.add_gridspec(2, len(shares), height_ratios=(1.35, 1.0))
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
    for k, ((speed, share), picture) in enumerate(zip(shares.items(), pictures)):
        panel = figure.add_subplot(grid[1, k])
        panel.imshow(picture)
        panel.set_title(
            f"{speed:g} m/s, $H_s$ {developed(speed)[0]:.1f} m: {100 * monahan_cover(speed):.1f} %, "
            f"here {100 * share:.1f} %",
            fontsize=10,
        )
        panel.set_axis_off()
    save_figure(figure, path, "A title names the white part of the whole sea, and of the piece that is shown")


def main() -> None:
    asked = options(__doc__, "fewer points, winds and moments, small pictures")
    points = 128 if asked.fast else POINTS
    winds = sorted({*WINDS[:: 4 if asked.fast else 1].tolist(), *SHOWN})
    rows = []
    for done, wind in enumerate(winds):
        height, period = developed(wind)
        elevation, convergence = sea(wind, points)
        wanted = monahan_cover(wind)
        foam = white_shares(convergence, wanted)
        least = float(convergence[foam > 0.0].min())
        mean = float(foam_by_height(elevation).mean())
        rows.append((wind, height, period, wanted, float(foam.mean()), least, mean, mean_foam_by_height(height)))
        progress(0.5 * (done + 1) / len(winds), f"a sea under {wind:g} m/s")
    head = [f"fully developed seas of {SPECTRUM_WAVES} waves, {points} x {points} points over six peak wavelengths"]
    head += ["foam where the convergence of crests is above `convergence`; thesis: height over 0.8 m, cut to 0 and 1"]
    columns = ["u10_m_s", "hm0_m", "tp_s", "measured_at_sea", "drawn", "convergence", "thesis", "thesis_closed_form"]
    chosen = {wind: typical_moment(wind, MOMENTS[:: 6 if asked.fast else 1]) for wind in SHOWN}
    seen = [f"{share:.4f} at {wind:g} m/s after {time:g} s" for wind, (_, time, share) in chosen.items()]
    head += [f"white shares of the pixels of the pictures: {', '.join(seen)}"]
    save_table(asked.out / "fig6_4.csv", head, columns, rows)
    seas = {wind: waves for wind, (waves, _, _) in chosen.items()}
    pictures, bare = sea_pictures(seas, (320, 240) if asked.fast else (800, 600))
    save_picture(asked.out / "fig6_4_bare.png", np.concatenate(list(bare), axis=1))
    draw_figure(rows, {wind: share for wind, (_, _, share) in chosen.items()}, pictures, asked.out / "fig6_4.png")
    progress(1.0, "done")


if __name__ == "__main__":
    main()
