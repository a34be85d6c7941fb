"""A dam breaks on a box.

The tank of Kleefsman et al. (2005): a column of water collapses, runs along the floor and hits a box. Gauges record the
height of the water and the pressure on the box.
"""

# %%
# Start from the scene that comes with the program. Overrides change single keys, as `--set` does; here coarser
# water, so that it takes seconds, and gauges: one height behind the box, one pressure on its front.

import numpy as np

import ocean_sim

scene = ocean_sim.load(
    "gallery/dam_break_on_a_box",
    {
        "fluid.spacing": 0.1,
        "duration": 0.8,
        "surface": None,
        "frames": None,
        "render": None,
        "gauges": {"every": 0.01, "elevation": {"column": [-1.0, 0.0]}, "pressure": {"front": [0.61, -0.94, 0.0]}},
    },
)
print(scene.preflight.particles, "particles")
result = ocean_sim.run(scene, out="runs/dam_break", overwrite=True)

# %%
# The column sinks, and the front arrives at the box after about half a second: until then the gauge on its front is
# dry.

time = result.gauges["time_s"]
column, front = result.gauges["column_m"], result.gauges["front_Pa"]
arrival = float(time[np.argmax(front > 200.0)])
print(f"the column has sunk by {column[0] - column[-1]:.2f} m; the front arrives at {arrival:.2f} s")
print(f"highest pressure on the box {1e-3 * front.max():.1f} kPa")
assert column[-1] < column[0] - 0.05
assert 0.3 < arrival < 0.7

from matplotlib.figure import Figure

figure = Figure(figsize=(7.0, 4.0), layout="constrained")
level, push = figure.subplots(2, sharex=True)
level.plot(time, column)
level.set_ylabel("level of the column [m]")
push.plot(time, 1e-3 * front)
push.axvline(arrival, linestyle=":", label=f"arrival, {arrival:.2f} s")
push.set(xlabel="time [s]", ylabel="pressure on the box [kPa]")
push.legend()
figure.savefig("runs/dam_break_on_a_box.png", dpi=150)

# %%
# Is the water still water? `accuracy.csv` says how far it was compressed, and whether mass and momentum were kept.

worst = float(result.accuracy["compression_max"].max())
print(f"compressed by at most {worst:.1%}")

# %%
# The measured experiment is the case `obstacle`: `ocean-sim validate obstacle` compares heights at four places and
# pressures at eight with it, at the resolution for which its tolerances are meant. To see the water, leave `surface`
# and `render` on, or draw the run later with `ocean-sim render runs/dam_break`.
