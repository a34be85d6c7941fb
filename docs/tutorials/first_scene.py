"""Your first scene.

A scene is a text file. Ten lines make a tank with a wave in it, and a gauge that records the height of the water. At
the end you know how far the simulated period is from theory; every claim of this program is made in this way.
"""

# %%
# Write the scene. `basin` without a `width` is 2-D, a vertical slice: quick to compute. The water is
# `delta_sph`, the scheme to rely on; it starts as a standing wave of half a wavelength in the tank.

from math import pi, sqrt, tanh
from pathlib import Path

Path("first.yaml").write_text("""\
title: A standing wave in a tank of two metres
seed: 1
duration: 3.5                                      # [s]
basin: {length: 2.0, depth: 1.0}                   # [m]
fluid:
  kind: delta_sph
  spacing: 0.1                                     # [m] between particles: 200 of them
  initial: {kind: standing_wave, height: 0.1}      # [m] from trough to crest
gauges: {elevation: {end: [-0.9]}}                 # [m] along x
frames: null                                       # keep nothing to draw
""")

# %%
# On the command line you would now type `ocean-sim check first.yaml` and `ocean-sim run first.yaml`. From Python the
# same takes two calls. A scene is checked when it is loaded: a misspelled key is refused, and the likeliest one is
# suggested.

import ocean_sim

scene = ocean_sim.load("first.yaml")
print(scene.preflight.particles, "particles")
result = ocean_sim.run(scene, out="runs/first", overwrite=True)

# %%
# The run folder holds tables, and `result` reads them by column. The elevation at the gauge oscillates about zero; it
# crosses zero twice in a period, a little later on the way down than on the way up: a wave has sharp crests.

import numpy as np

time, height = result.gauges["time_s"], result.gauges["end_m"]
height = height - height.mean()
swap = np.flatnonzero(np.diff(np.sign(height)))
crossings = time[swap] - height[swap] * (time[swap + 1] - time[swap]) / (height[swap + 1] - height[swap])
period = (crossings[2:] - crossings[:-2]).mean()

# %%
# Linear theory: omega^2 = g k tanh(k h), with k of half a wavelength in the tank.

k = pi / 2.0
theory = 2.0 * pi / sqrt(9.81 * k * tanh(k * 1.0))
print(f"period {period:.3f} s, linear theory {theory:.3f} s, {100.0 * (period / theory - 1.0):+.1f} %")
assert abs(period / theory - 1.0) < 0.05

# %%
# Draw both: theory begins with the simulated crest.

from matplotlib.figure import Figure

figure = Figure(figsize=(7.0, 3.0), layout="constrained")
axes = figure.subplots()
axes.plot(time, height, label="simulated")
axes.plot(time, height.max() * np.cos(2.0 * pi * (time - time[height.argmax()]) / theory), ":", label="linear theory")
axes.set(xlabel="time [s]", ylabel="elevation at the end [m]")
axes.legend()
figure.savefig("runs/first_scene.png", dpi=150)

# %%
# Ten rows of particles over the depth are few. Halve the spacing with `--set fluid.spacing=0.05`, and compare.
# `ocean-sim tradeoff` does that experiment over all settings. Then look at the same wave in the table of
# [validation](validation.md), and go on with [a gust and a real wind](tutorial_gust_and_real_wind.md).
