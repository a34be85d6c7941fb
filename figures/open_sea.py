"""A patch of open sea: height and phase of a regular wave along it, for five speeds of the rim, beside the model.

Slices of three wavelengths under delta_sph, 40 particles to the wave, steepness ka 0.05; with the feed, and without it
at the speed of the wave's own energy, where no rim can renew it. Dots: least squares of the velocities in windows of
half a wavelength, over the last five periods of 25; lines: the equation of one line in
`fluid/patch/relaxation_zone.py`, in which a wave without a feed that keeps up with the rim is lost outside it.

python figures/open_sea.py [--fast] [--out DIR]
"""

from typing import Any

import numpy as np
from _options import options, progress
from _paper import BLUE, GREEN, INK, ORANGE, PALE, RED, paper, save_figure, save_table

from ocean_sim.fluid.patch.relaxation_zone import relaxation_band
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.simulation import Simulation
from ocean_sim.validation.open_sea_waves import (
    COARSE_PARTICLES,
    FINE_PARTICLES,
    GROUP_SPEED,
    PATCH_LENGTH,
    PERIOD,
    PERIOD_SAMPLES,
    K,
    fit_wave,
    patch_scene,
)
from ocean_sim.validation.shared.state import sampled_states

KA, PERIODS, FAST_PERIODS, JUDGED = 0.05, 25.0, 2.0, 5.0
LEAST = 0.01  # height over that of the sea below which a phase says nothing
SPEEDS = {-1.0: BLUE, 0.0: INK, 0.5: GREEN, 1.0: RED, 1.5: ORANGE}  # [group speeds]
PLACES = np.linspace(-1.25, 1.25, 11)  # [wavelengths] from the ship


def scene(speed: float, feed: float | None, particles: int, periods: float) -> Any:
    """Scene of a wave on a patch, `particles` to its length, with a `feed` and a rim at a `speed` [group speeds]."""
    rim = {"velocity": [speed * GROUP_SPEED, 0.0]}
    sea = {"height": 2.0 * KA / K, "period": PERIOD, "rim": rim, "feed": feed}
    quiet = dict.fromkeys(name for name in observer_names() if name != "manifest")
    keys = quiet | patch_scene(PATCH_LENGTH, particles, sea, periods)
    keys["fluid"]["kind"] = "delta_sph"
    return load(keys)


def mean_waves(config: Any, speed: float, judged: float, report: Any) -> np.ndarray:
    """Mean complex wave height at PLACES over the sea's, in the last `judged` periods; `report`: takes progress."""
    found, until = [], config.duration
    with Simulation(config) as simulation:
        for water in sampled_states(simulation, until, PERIOD / PERIOD_SAMPLES):
            report(water.time / until)
            if water.time > until - judged * PERIOD:
                found.append([fit_wave(water, KA / K, speed * GROUP_SPEED * water.time + place)[0] for place in PLACES])
    return np.mean(found, axis=0)


def main() -> None:
    asked = options(__doc__, "coarse water, two periods")
    particles, periods = (COARSE_PARTICLES, FAST_PERIODS) if asked.fast else (FINE_PARTICLES, PERIODS)
    cases = [(speed, None, colour) for speed, colour in SPEEDS.items()] + [(1.0, 0.0, RED)]
    judged = min(JUDGED, 0.5 * periods)
    figure, rows = paper(10.0, 4.4), []
    height, phase = figure.subplots(1, 2)
    for number, (speed, feed, colour) in enumerate(cases):
        config = scene(speed, feed, particles, periods)
        where = f"{speed:+g} group speeds" if speed else "at rest"
        name = where if feed is None else f"{where}, no feed"
        a = mean_waves(config, speed, judged, lambda part, n=number, name=name: progress((n + part) / len(cases), name))
        model = relaxation_band(config.fluid.lattice(config.preflight.tank))
        assert model is not None
        along = model.height_profile(speed)
        assert along is not None
        style = "-" if feed is None else "--"
        seen = np.abs(along[1]) > LEAST  # a wave that is lost has no phase
        for panel, line, dots in (
            (height, np.abs(along[1]), np.abs(a)),
            (phase, np.where(seen, np.degrees(np.angle(along[1])), np.nan), np.degrees(np.angle(a))),
        ):
            panel.plot(along[0], line, style, color=colour, lw=1.2)
            panel.plot(PLACES, dots, "o", color=colour, ms=4, label=name, fillstyle="full" if feed is None else "none")
        rows += [
            (speed, "" if feed is None else feed, x, abs(y), float(np.degrees(np.angle(y)))) for x, y in zip(PLACES, a)
        ]
    for panel, title in ((height, "height over that of the sea"), (phase, "phase [deg]")):
        panel.axvspan(-1.5, -0.75, color=PALE, alpha=0.5)
        panel.axvspan(0.75, 1.5, color=PALE, alpha=0.5)
        panel.set(xlabel="from the ship, with the waves [wavelengths]", title=title, xlim=(-1.5, 1.5))
        panel.grid(color=PALE, lw=0.7)
        panel.text(1.125, 0.02, "rim", transform=panel.get_xaxis_transform(), ha="center", fontsize=8)
    height.set_ylim(0.0, 1.2)
    phase.set_ylim(-45.0, 45.0)
    height.legend(fontsize=8, title="dots: particles; lines: model, in the end", title_fontsize=8)
    size = f"a patch of {PATCH_LENGTH:g} wavelengths, rim 0.75 on either side"
    head = [f"{size}, ka {KA:g}, {particles} particles to the wave"]
    head += [f"the mean of the last {judged:g} of {periods:g} periods; feed: empty is the default"]
    save_table(asked.out / "open_sea.csv", head, ["speed", "feed", "place", "height", "phase_deg"], rows)
    save_figure(figure, asked.out / "open_sea.png")
    progress(1.0, "done")


if __name__ == "__main__":
    main()
