"""A gust of the thesis against a real wind.

The winds of the thesis are force fields: they push every particle within a box, deep or shallow. A real wind acts on
the surface alone. Here both blow over the same water, and you see how many times stronger the gust is.
"""

# %%
# The water of the thesis, coarse: `fluid.spacing` 2.5 m instead of 1.25 m. The wind is the only thing that differs.

import numpy as np

import ocean_sim

WATER = {
    "duration": 3.0,
    "basin": {"length": 40.0, "width": 40.0, "depth": 7.5},
    "fluid": {"kind": "delta_sph", "spacing": 2.5},
    "gauges": {"elevation": {"centre": [0.0, 0.0], "lee": [-12.0, 7.0]}},
    "frames": None,
}
gust = ocean_sim.load(WATER | {"wind": "wide"})
real = ocean_sim.load(WATER | {"wind": {"kind": "stress", "u10": 10.0, "heading_deg": 300.0}})

# %%
# What a reader of the results should know is a warning of the scene. `ocean-sim check` prints the same.

for warning in gust.warnings():
    print("gust:", warning)
assert any("stylised force field" in warning for warning in gust.warnings())
assert not any("stylised" in warning for warning in real.warnings())

# %%
# Run both, and look at the momentum along the wind that each has given to the water: `accuracy.csv` sums the impulse of
# every term.

given = {}
levels = {}
for name, scene in (("gust", gust), ("real", real)):
    result = ocean_sim.run(scene, out=f"runs/{name}", overwrite=True)
    impulse = np.stack([result.accuracy[f"impulse_wind_{axis}_Ns"] for axis in "xz"])
    given[name] = float(np.hypot(*impulse[:, -1]))
    levels[name] = result.gauges["time_s"], result.gauges["lee_m"]
    swing = float(np.ptp(result.gauges["lee_m"]))
    print(f"{name}: {given[name]:.3g} N s from the wind, the level at the lee gauge varies by {1e3 * swing:.1f} mm")
assert given["gust"] > 100.0 * given["real"] > 0.0

from matplotlib.figure import Figure

figure = Figure(figsize=(7.0, 3.0), layout="constrained")
axes = figure.subplots()
for name, (time, level) in levels.items():
    axes.plot(time, level, label=name)
axes.set(xlabel="time [s]", ylabel="level at the lee gauge [m]")
axes.legend()
figure.savefig("runs/gust_and_real_wind.png", dpi=150)

# %%
# Both are useful. The gust shows in seconds what a wind does in hours, but it is not a wind: no claim about real waves
# follows from it. For such a claim take `stress`, state its `gain` if you use one, and give it time.
