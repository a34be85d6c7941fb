"""Figure 2-1: smoke from a chimney in a turning wind, measured at a fixed place (Euler) and along with the smoke
(Lagrange): CSV and PNG.

The wind blows at a steady speed and swings up and down with time, everywhere alike, so every path is a closed form; a
puff cools exponentially with its age. What a thermometer reads at a place is (2.5), the sum over the puffs around it.

python figures/fig2_1.py [--fast] [--out DIR]
"""

from pathlib import Path

import numpy as np
from _options import options
from _paper import BLUE, GREY, INK, PALE, RED, paper, save_figure, save_table

from ocean_sim.fluid.sph.smoothing import Smoothing

SPEED, SWING, PERIOD = 3.0, 1.1, 12.0  # of the wind [m/s], its part across [m/s], time of a swing [s]
RISE, RISES = 1.0, 4.0  # of fresh smoke [m/s], and how long [s]
AIR, HOT, COOLS = 15.0, 60.0, 5.0  # [deg C], fresh smoke above it [K], time over which it cools [s]
CHIMNEY, PLACE = np.array([0.0, 12.0]), np.array([22.0, 15.6])  # top, and o [m]
WIDE = 2.4  # support of a puff [m]
LASTS, EVERY = 36.0, 0.1  # [s]
BORN, SHOWN = 17.0, 29.0  # particle A leaves the chimney; the time of the picture [s]


def puff_positions(born: np.ndarray, time: float) -> np.ndarray:
    """Positions (n, 2) [m], at a time [s], of puffs that left the chimney at times `born` (n,) [s]."""
    age, turn = time - born, 2.0 * np.pi / PERIOD
    across = SWING / turn * (np.cos(turn * born) - np.cos(turn * time))
    up = RISE * RISES * (1.0 - np.exp(-age / RISES))
    return CHIMNEY + np.stack([SPEED * age, across + up], axis=1)


def excess_temperature(born: np.ndarray, time: float) -> np.ndarray:
    """Temperature of puffs above that of the air (n,) [K]."""
    return HOT * np.exp(-(time - born) / COOLS)


def read_temperature(place: np.ndarray, time: float) -> float:
    """Temperature [deg C] at a place, as (2.5) sums it over puffs within WIDE. The breadth of a puff makes a straight
    plume show its own temperature on its middle line."""
    born = np.arange(time - LASTS, time, 0.5 * EVERY)
    constant = Smoothing(2, support=WIDE).poly6_constant
    across = constant * WIDE**7 * 32.0 / 35.0  # the kernel along a line through its middle, integrated [1/m]
    r2 = ((puff_positions(born, time) - place) ** 2).sum(axis=1)
    weight = constant * np.maximum(WIDE**2 - r2, 0.0) ** 3
    return AIR + float((weight * excess_temperature(born, time)).sum()) * SPEED * 0.5 * EVERY / across


def draw_figure(time: np.ndarray, fixed: np.ndarray, moving: np.ndarray, path: Path) -> None:
    """Draw the plume with the fixed place and the moving particle, and the temperature that each records."""
    figure = paper(13.0, 4.8)
    left, right = figure.subplots(1, 2, width_ratios=(1.45, 1.0))
    born = np.arange(SHOWN - 15.0, SHOWN, 0.12)
    x, y = puff_positions(born, SHOWN).T
    warm = excess_temperature(born, SHOWN)
    shade = left.scatter(x, y, c=AIR + warm, s=90 + 12 * (SHOWN - born), cmap="YlOrBr", alpha=0.55, lw=0, vmin=AIR)
    figure.colorbar(shade, ax=left, label="temperature of the smoke [°C]", location="bottom", shrink=0.6, aspect=40)
    left.fill([-0.8, 0.8, 0.5, -0.5], [0.0, 0.0, 12.0, 12.0], color=GREY)
    way = np.array([puff_positions(np.array([BORN]), t)[0] for t in np.arange(BORN, SHOWN + 0.01, 0.1)])
    left.plot(*way.T, color=RED, lw=1.8, ls="--")
    for t in np.arange(BORN + 2.0, SHOWN + 0.01, 2.0):
        left.plot(*puff_positions(np.array([BORN]), t)[0], "o", color=RED, ms=5, mec="white")
    left.annotate("A", way[-1], (6, 4), textcoords="offset points", color=RED, fontsize=13, weight="bold")
    left.plot(*PLACE, "s", color=BLUE, ms=9, mec="white")
    left.annotate("o", PLACE, (-4, -20), textcoords="offset points", color=BLUE, fontsize=13, weight="bold")
    left.annotate("", (9.0, 24.5), (3.0, 24.5), arrowprops={"arrowstyle": "-|>", "color": INK})
    left.text(6.0, 25.0, f"wind {SPEED:g} m/s", ha="center", fontsize=9, color=INK)
    left.set(xlabel="x [m]", ylabel="y [m]", title=f"the plume at {SHOWN:g} s", xlim=(-2, 45), ylim=(0, 27))
    left.set_aspect("equal")
    along = time >= BORN
    right.plot(time, fixed, color=BLUE, lw=2.0, label=r"at o (Euler): $T(t, x_o, y_o)$")
    right.plot(time[along], moving[along], color=RED, lw=2.0, ls="--", label="on particle A (Lagrange): $T_A(t)$")
    right.axhline(AIR, color=GREY, lw=0.8)
    right.text(LASTS, AIR - 0.8, "air", ha="right", va="top", color=GREY, fontsize=9)
    right.set(
        xlabel="time [s]", ylabel="temperature [°C]", title="the two thermometers", xlim=(0, LASTS), ylim=(10, 94)
    )
    right.legend(loc="upper left")
    right.grid(color=PALE, lw=0.7)
    save_figure(figure, path)


def main() -> None:
    out = options(__doc__).out
    time = np.arange(0.0, LASTS + 0.5 * EVERY, EVERY)
    fixed = np.array([read_temperature(PLACE, t) for t in time])
    aboard = time >= BORN - 1e-9
    moving = np.where(aboard, AIR + HOT * np.exp(-(time - BORN) / COOLS), np.nan)
    where = [puff_positions(np.array([BORN]), t)[0] if on else (np.nan, np.nan) for t, on in zip(time, aboard)]
    head = [f"o lies at ({PLACE[0]:g}, {PLACE[1]:g}) m; particle A leaves the chimney at {BORN:g} s"]
    columns = ["time_s", "at_o_degC", "on_A_degC", "A_x_m", "A_y_m"]
    rows = [(float(t), o, a, float(p[0]), float(p[1])) for t, o, a, p in zip(time, fixed.tolist(), moving, where)]
    save_table(out / "fig2_1.csv", head, columns, rows)
    draw_figure(time, fixed, moving, out / "fig2_1.png")


if __name__ == "__main__":
    main()
