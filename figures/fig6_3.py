"""Figure 6-3 as trends: what range, speed, duration and fetch of a stylised wind do to the waves, next to still air;
the circulation of its presets; and a picture of the sea that each raises, together and one by one: CSV and PNG.

Coarse water, 2.5 m apart: three whole layers, which lie still where no wind blows. Heights are 4 sqrt m0 over time at
25 gauges from SETTLED s on, when the lattice has settled; the gusts of the trends begin then, the presets at once.
Fetch is studied alone, in 2-D of water 1.25 m apart: gust after gust goes over the fetch and over a beach behind it
that absorbs, so every place of every basin is blown on as often; they go at 8 m/s, slower than the longest wave of this
depth (8.6 m/s), for waves do not grow under a gust that outruns them; and heights are those of the last quarter of the
fetch from when the first gusts have passed. The slice moves by delta_sph, with the viscosity of thesis_6000, whose own
scheme does not lie still there without wind: its lattice breaks up by itself between 10 s and 30 s, into waves of 0.15
to 0.3 m and a level 0.12 m lower, and of 4 sqrt m0 0.09 m have not gone after 120 s.
By delta_sph still air has 0.01 mm. A range of 8 m and a speed of 1 are the same gust, and one run.
Every preset is noisy, so its seeds differ. Orange lines and arrows show a wind when it blew over the middle of the
basin, crosses where it is nothing but noise. The third row is another water: spectral_sea, which is calm until the
winds of the four printed presets press on it, on a tile of twice the basin; what they push along makes no waves there,
so that a vortex, which but for its noise only pushes along, leaves it flat. No period T_z is told of fewer than COUNTED
waves.

python figures/fig6_3.py [--fast] [--out DIR]
"""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from _options import options, progress
from _paper import BLUE, INK, ORANGE, PALE, paper, save_figure, save_table, set_plan

from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.waves.orbits import circulation
from ocean_sim.waves.record import even_samples, zero_crossing_waves
from ocean_sim.wind import Drawing

SETTLED, LASTS = 5.0, 15.0  # [s]
QUIET = dict.fromkeys(("accuracy", "timings", "health", "frames", "render", "report"))
PRESETS = ("noise_only", "narrow", "wide", "vortex", "calm", "breeze", "gale", "squall")
SPECTRAL = {"kind": "spectral_sea", "tile": 80.0, "cells": 64}  # 1.25 m
PRINTED = {"noise_only": "(a) ", "narrow": "(b) ", "wide": "(c) ", "vortex": "(d) "}
FETCH, FETCHES, BEACH = "fetch [m]", (20.0, 40.0, 80.0), 40.0  # [m]
GUST_SPEED, GUST_GAP, MIN_IRREGULAR_WAVES = (
    8.0,
    40.0,
    18.0,
)  # [m/s], [m] from gust to gust, [s] when the first have passed
SLICE = {"kind": "delta_sph", "spacing": 1.25, "kinematic_viscosity": 1.0}
COUNTED, FLAT = 20, 0.05  # waves of all gauges from which a period is told in a picture; [m] below which none is seen
STEP = 0.5  # [m] to a multiple of which the range of colours is rounded up
WEAK, LONGEST, TOP = 0.15, 9.0, 2.0  # arrows of which there are crosses instead; the longest [m]; how high they are [m]
RING = 8.0  # [m] radius at which circulation is taken


def gust(range_m: float = 8.0, acceleration: float = 1.0, drift: float = 10.0, **keys: float) -> dict:
    """Wind keys of a gust along x, like the preset `wide` but straight; `range_m`: its length along the wind [m]."""
    box = {"kind": "box", "half_size": [range_m / 2, 15.0, 25.0], "centre": [-20.0 - range_m / 2, 0.0, 0.0]}
    push = [1.5 * acceleration, 2.1 * acceleration, 0.0]
    volume = {"include": [box], "acceleration": push, "noise": [0.5, 0.5, 0.5], "drift": drift, "start": SETTLED}
    return {"kind": "gusts", "volumes": [{**volume, **keys}]}


def varied_winds() -> list[tuple[str, float, dict, float]]:
    """Rows of the trends: name of the varied quantity, its value, wind keys, and length of the basin [m]."""
    rows = [("range [m]", x, gust(range_m=x), 40.0) for x in (2.0, 4.0, 8.0)]
    # A faster gust of the same thrust kicks less; what rises with the speed of its air is the acceleration, as U^2.
    rows += [("speed [of wide]", x, gust(acceleration=x * x), 40.0) for x in (0.5, 0.75, 1.0)]
    rows += [("duration [s]", x, gust(duration=x), 40.0) for x in (1.5, 3.0, 6.0)]
    return rows


def gust_train(length: float, lasts: float) -> dict:
    """Wind keys of gusts in a row, a quarter as strong as `gust`; the first arrives once the lattice has settled."""
    places = np.arange(-length / 2 - 4.0 - GUST_SPEED * SETTLED, -length / 2 - GUST_SPEED * lasts, -GUST_GAP)
    volumes = []
    for x in places:
        box = {"kind": "box", "half_size": [4.0, 15.0, 25.0], "centre": [float(x), 0.0, 0.0]}
        push, noise = [0.375, 0.525, 0.0], [0.5, 0.5, 0.5]
        volumes.append({"include": [box], "acceleration": push, "noise": noise, "drift": GUST_SPEED})
    return {"kind": "gusts", "volumes": volumes}


class Waves(NamedTuple):
    """Statistics of one sea."""

    hm0: float  # 4 sqrt m0 over time [m]
    hs: float  # mean height of the highest third of all waves between zero up-crossings, of all gauges together [m]
    tz: float  # their mean period [s]
    crest: float  # [m]
    waves: int  # whole ones of all gauges together
    circulation: float  # at the end [m2/s]; not a number in 2-D and where nothing turns


class View(NamedTuple):
    """Data of a picture of one sea."""

    chart: tuple[np.ndarray, np.ndarray, np.ndarray]  # places [m] and elevation [m] at the end
    wind: Drawing  # when it blew most strongly and nearest to the middle


def sea(
    wind: dict | str, length: float, seed: int, lasts: float, resolution: float, fluid: str | dict = "thesis_6000"
) -> tuple[Waves, View]:
    """Run a wind over water for `lasts` [s]. Return statistics of its waves, and data to draw them."""
    scene = {
        "title": "figure 6-3",
        "seed": seed,
        "duration": lasts,
        "basin": {"length": length, "width": 40.0, "depth": 7.5},
        "fluid": fluid,
        "wind": wind,
        "resolution": resolution,
        **QUIET,
    }
    side = np.linspace(-0.4, 0.4, 5)
    x, z = np.meshgrid(side * length, side * 40.0)
    gauges, times, heights = np.stack([x.ravel(), z.ravel()], axis=1), [], []
    with Simulation(load(scene)) as simulation:
        turning, every, winds = [], 0.1, []
        while simulation.time < lasts:
            simulation.run(until=simulation.time + every)
            winds.append(simulation.wind.drawing())
            if simulation.time >= SETTLED:
                times.append(simulation.time)
                heights.append(simulation.fluid.elevations(gauges))
            water = simulation.fluid.particles
            if water is not None and simulation.time >= lasts - 2.0:
                turning.append(circulation(water.position.to_numpy(), water.velocity.to_numpy(), RING, 5.0))
        fine = [np.linspace(-0.48, 0.48, 49) * size for size in (length, 40.0)]
        x, z = np.meshgrid(*fine)
        top = simulation.fluid.elevations(np.stack([x.ravel(), z.ravel()], axis=1)).reshape(x.shape)
    turned = float(np.mean(turning)) if turning else float("nan")
    return Waves(*heights_of(times, heights), turned), View((fine[0], fine[1], top), min(winds, key=strength_order))


def strength_order(wind: Drawing) -> tuple[float, float]:
    """Sort key of moments of a wind: strongest first, then nearest to the middle of the basin."""
    if not len(wind.tails):
        return 0.0, 0.0
    strength = np.linalg.norm(wind.arrows, axis=1).max()
    return -round(float(strength), 1), float(np.linalg.norm(wind.tails[:, [0, 2]].mean(axis=0)))


def fetch_sea(fetch: float, blowing: bool, seed: int, lasts: float) -> Waves:
    """Run a 2-D slice of a fetch [m] before a beach; statistics of waves in the last quarter of the fetch."""
    length = fetch + BEACH
    scene = {
        "title": "figure 6-3, fetch",
        "seed": seed,
        "duration": lasts,
        "basin": {"length": length, "depth": 7.5, "walls": {"x_max": "absorbing"}},
        "fluid": SLICE,
        "wind": gust_train(length, lasts) if blowing else "still",
        **QUIET,
    }
    x = np.linspace(0.75, 1.0, 6) * fetch - length / 2
    gauges, times, heights = np.stack([x, 0.0 * x], axis=1), [], []
    with Simulation(load(scene)) as simulation:
        while simulation.time < lasts:
            simulation.run(until=simulation.time + 0.1)
            if simulation.time >= min(MIN_IRREGULAR_WAVES, 0.5 * lasts):
                times.append(simulation.time)
                heights.append(simulation.fluid.elevations(gauges))
    return Waves(*heights_of(times, heights), float("nan"))


def heights_of(times: list[float], heights: list[np.ndarray]) -> tuple[float, float, float, float, int]:
    """Statistics of all gauges together: 4 sqrt m0 [m], mean of the highest third [m], mean period [s], highest crest
    [m], and number of waves."""
    record = np.array(heights)
    waves = [zero_crossing_waves(*remove_mean(np.array(times), height)) for height in record.T]
    sizes, periods = (np.concatenate([each[k] for each in waves]) for k in (0, 1))
    highest = np.sort(sizes)[::-1][: max(1, round(len(sizes) / 3.0))]
    return (
        4.0 * float(np.sqrt(np.mean(record.var(axis=0)))),
        float(highest.mean()) if len(sizes) else float("nan"),
        float(periods.mean()) if len(sizes) else float("nan"),
        float(record.max()),
        len(sizes),
    )


def remove_mean(time: np.ndarray, height: np.ndarray) -> tuple[float, np.ndarray]:
    """Resample a record to equal intervals, and subtract its mean: interval [s] and values [m]."""
    interval, even = even_samples(time, height)
    return interval, even - even.mean()


def spread(values: list[float]) -> tuple[float, float]:
    """Mean and standard deviation of values; the latter is not a number for a single value."""
    return float(np.mean(values)), float(np.std(values, ddof=1)) if len(values) > 1 else float("nan")


def draw_figure(
    seas: dict[str, tuple[View, str, str]],
    spectral: dict[str, tuple[View, str, str]],
    trends: dict[str, list[tuple[float, ...]]],
    seeds: int,
    path: Path,
) -> None:
    """Draw the sea under each preset from above, also that of spectral_sea, and the four trends over so many seeds. The
    colours reach to the highest crest and the lowest trough of all these seas."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap
    from matplotlib.patheffects import withStroke

    halo = {"path_effects": [withStroke(linewidth=2.4, foreground="white")], "zorder": 4}
    light = ListedColormap(colormaps["RdBu_r"](np.linspace(0.05, 0.95, 256)))  # arrows are darker than any colour of it
    drawn = [*seas.items(), *spectral.items()]
    reach = STEP * np.ceil(max(np.abs(view.chart[2]).max() for _, (view, *_) in drawn) / STEP)
    blown = f"wind, {seeds} seeds:\nmean, standard deviation" if seeds > 1 else "wind, one seed"
    figure = paper(15.0, 14.8)
    axes = figure.subplots(4, 4, height_ratios=(1.15, 1.15, 1.15, 1.0))
    for panel, (name, (view, caption, turning)) in zip(axes[:3].ravel(), drawn):
        x, z, top = view.chart
        image = panel.pcolormesh(x, z, top, vmin=-reach, vmax=reach, cmap=light, shading="auto", rasterized=True)
        letter = PRINTED.get(name, "")
        panel.set_title(f"{letter}{name.replace('_', ' ')}{turning}\n{caption}", fontsize=9.5, loc="left")
        set_plan(panel, aspect="equal", xlim=(-20.0, 20.0), ylim=(-20.0, 20.0))
        lines, arrows, noise = marks(view.wind)
        panel.plot(*lines[[0, 2]], color=ORANGE, lw=1.2)
        size = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.009}
        panel.quiver(*arrows[:, [0, 2]].reshape(4, -1), color=INK, **size, **halo)
        panel.plot(*noise[[0, 2]], "x", color=INK, ms=5.0, **halo)
    figure.colorbar(image, ax=axes[:3].ravel().tolist(), label="elevation [m]", shrink=0.6)
    for panel, (what, rows) in zip(axes[3], trends.items()):
        value, mean, deviation, still = np.array(rows).T
        bars = deviation if seeds > 1 else None
        panel.errorbar(value, mean, bars, marker="o", capsize=3.0, color=BLUE, label=blown)
        panel.plot(value, still, "--", color=INK, label="still air")
        panel.set(xlabel=what, ylabel=r"$4\sqrt{m_0}$ [m]", ylim=(0.0, max(mean + np.nan_to_num(deviation)) * 1.35))
        panel.grid(color=PALE, lw=0.7)
        panel.legend(loc="upper left")
    save_figure(figure, path)


def marks(wind: Drawing) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Marks of a wind over the basin: points (3, n) of its outlines, with NaN between separate ones; starts and
    directions (2, 3, m) of level arrows; and places (3, k) of noise [m]."""
    share = np.append(np.linspace(0.0, 1.0, 41), np.nan)[:, None]
    lines = (wind.lines[:, :1] + share * (wind.lines[:, 1:] - wind.lines[:, :1])).reshape(-1, 3)
    lines[np.abs(lines[:, [0, 2]]).max(axis=1, initial=0.0) > 20.0] = np.nan
    over = np.abs(wind.tails[:, [0, 2]]).max(axis=1, initial=0.0) <= 20.0
    blowing = over & (np.linalg.norm(wind.arrows, axis=1) > WEAK)
    lines[:, 1], level = np.clip(lines[:, 1], 0.0, TOP), np.array([1.0, 0.0, 1.0])
    tails, arrows = wind.tails * level + [0.0, TOP, 0.0], LONGEST * wind.arrows * level
    return lines.T, np.stack([tails[blowing].T, arrows[blowing].T]), tails[over & ~blowing].T


def draw_sea(view: View, name: str, lasts: float, path: Path) -> None:
    """Draw the sea under one preset at the end of its run from the side, and its wind when it blew over the middle."""
    x, z, top = view.chart
    figure = paper(2.8, 2.0)
    axes = figure.add_subplot(projection="3d", computed_zorder=False)
    across, along = np.meshgrid(z, x, indexing="ij")  # `top` has a row for each z
    shaded = {"cmap": "GnBu_r", "vmin": -2.5, "vmax": 2.5, "rcount": 49, "ccount": 49, "antialiased": False}
    axes.plot_surface(along, across, top, **shaded)
    lines, arrows, noise = marks(view.wind)
    axes.plot(*lines[[0, 2, 1]], color=ORANGE, lw=0.8)
    axes.quiver(*arrows[:, [0, 2, 1]].reshape(6, -1), color=INK, lw=0.9, arrow_length_ratio=0.4)
    axes.plot(*noise[[0, 2, 1]], "x", color=INK, ms=2.5, mew=0.7)
    axes.set(zlim=(-2.5, 2.5), xticks=(-20, 0, 20), yticks=(-20, 0, 20), zticks=(-2, 2))
    axes.set_box_aspect((4.0, 4.0, 1.0), zoom=1.1)
    axes.yaxis.set_inverted(True)
    axes.view_init(elev=30.0, azim=-60.0)
    axes.grid(False)
    axes.tick_params(labelsize=5.0, pad=-4.0)
    words = f"Figure 6-3, {PRINTED.get(name, '')}{name.replace('_', ' ')}: the sea at {lasts:g} s; x, z, elevation in m"
    save_figure(figure, path, words)


def summary(runs: list[Waves]) -> tuple[str, str]:
    """Texts for a picture: height and period under a wind, and circulation, with their spread over seeds."""
    rows = [spread([getattr(run, name) for run in runs]) for name in ("hm0", "tz", "circulation")]
    (hs, hs_sd), (tz, tz_sd), (turn, turn_sd) = rows
    several = len(runs) > 1
    turning = f", Γ {round(turn)}" + (f"±{turn_sd:.0f}" if several else "") + " m²/s" if np.isfinite(turn) else ""
    height = f"$4\\sqrt{{m_0}}$ {hs:.2f}" + (f"±{hs_sd:.2f}" if several else "") + " m"
    period = f"$T_z$ {tz:.1f}" + (f"±{tz_sd:.1f}" if several else "") + " s"
    if hs < FLAT:
        words = f"no waves: $4\\sqrt{{m_0}}$ {hs:.2f} m"
    elif np.isfinite(tz) and min(run.waves for run in runs) >= COUNTED:  # else the record is too short for a period
        words = f"{height}, {period}"
    else:
        words = f"{height}, no $T_z$: few waves"
    return words, turning.replace("-", "−")


def main() -> None:
    asked = options(__doc__, "one seed, and shorter")
    seeds, resolution, lasts = ((1,), 2.0, 12.0) if asked.fast else ((1, 2, 3, 4, 5), 2.0, LASTS)
    steady = 35.0  # [s] also in haste: the waves must come to the end of the longest fetch
    cases: list[tuple[str, Any, dict | str, float]] = [("preset", name, name, 40.0) for name in PRESETS]
    cases += varied_winds()
    cases += [("spectral_sea", name, name, 40.0) for name in PRINTED]
    cases += [(FETCH, fetch, {}, fetch) for fetch in FETCHES]
    calm = sea("still", 40.0, seeds[0], lasts, resolution)[0].hm0
    columns = ["what", "value", "length_m", "seeds", "hm0_m", "hm0_sd_m", "still_hm0_m", "still_over_hm0"]
    columns += ["crest_m", "circulation_m2_s", "circulation_sd_m2_s", "sigmas", "hs_m", "hs_sd_m", "tz_s", "tz_sd_s"]
    seas: dict[str, tuple[View, str, str]] = {}
    spectral: dict[str, tuple[View, str, str]] = {}
    trends: dict[str, list[tuple[float, ...]]] = {}
    rows = []
    finished: dict[str, tuple[list[Waves], list[View]]] = {}  # by wind and water
    for done, (what, value, wind, length) in enumerate(cases):
        water = SPECTRAL if what == "spectral_sea" else "thesis_6000"
        runs, views = finished.setdefault(repr((wind, length, water)), ([], []))
        for seed in seeds[len(runs) :]:
            share = (done + len(runs) / len(seeds)) / len(cases)
            progress(share, f"{what} {value}, seed {seed}")
            if what == FETCH:
                runs.append(fetch_sea(value, True, seed, steady))
            else:
                waves, view = sea(wind, length, seed, lasts, resolution, water)
                runs.append(waves)
                views.append(view)
        still = (
            fetch_sea(value, False, seeds[0], steady).hm0 if what == FETCH else 0.0 if what == "spectral_sea" else calm
        )
        mean, deviation = spread([run.hm0 for run in runs])
        turn, scatter = spread([run.circulation for run in runs])
        sigmas = abs(turn) / (scatter / len(seeds) ** 0.5) if scatter > 0.0 else float("nan")
        numbers = [mean, deviation, still, still / mean, max(run.crest for run in runs)]
        numbers += [turn, scatter, sigmas, *spread([run.hs for run in runs]), *spread([run.tz for run in runs])]
        rows.append((what, value, length, len(seeds), *(f"{n:.4g}" if np.isfinite(n) else "" for n in numbers)))
        if what == "preset":
            seas[value] = views[0], *summary(runs)
            draw_sea(views[0], value, lasts, asked.out / f"fig6_3_{value}.png")
        elif what == "spectral_sea":
            spectral[f"spectral sea, {value}"] = views[0], *summary(runs)
        else:
            trends.setdefault(what, []).append((value, mean, deviation, still))
    head = [f"thesis_6000 at {resolution:g} times its spacing; from {SETTLED:g} to {lasts:g} s"]
    head += [f"fetch: a slice by delta_sph, the last quarter of the fetch, to {steady:g} s"]
    head += ["range 8 and speed 1 are the same gust, and one run; one seed has no standard deviation"]
    head += ["stylised force fields, not physical stresses; sigmas: mean circulation over its standard error"]
    head += [
        "hm0: 4 sqrt m0 over time at 25 gauges; hs: highest third of the waves of all gauges, tz: their mean period"
    ]
    save_table(asked.out / "fig6_3.csv", head, columns, rows)
    draw_figure(seas, spectral, trends, len(seeds), asked.out / "fig6_3.png")


if __name__ == "__main__":
    main()
