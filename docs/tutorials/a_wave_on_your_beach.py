"""A wave on your beach.

A beach that was surveyed becomes the bed of a flume, a solitary wave comes ashore, and a plot shows how far it runs up.
"""

# %%
# A survey is a table of places and heights. Replace these few lines by your own file: x [m] towards the land, y [m]
# above the still water. Here the foreshore is 1:15, and steeper at the shore.

from pathlib import Path

import numpy as np

import ocean_sim

survey = Path("runs/beach_survey.csv")
survey.parent.mkdir(exist_ok=True)
survey.write_text("x_m,y_m\n-1.0,-0.30\n2.0,-0.10\n3.2,0.02\n5.0,0.26\n")
profile = np.loadtxt(survey, delimiter=",", skiprows=1)

# %%
# The flume goes on at the depth of the survey's first point, to a piston. A solitary wave a quarter as high as the
# water is deep needs about eight depths to form. Friction matters: without it thin water runs up much too far.

depth = -float(profile[0, 1])
bed = [[-3.6, -depth], *profile.tolist()]
height, length = 0.25 * depth, bed[-1][0] - bed[0][0]
middle = 0.5 * (bed[-1][0] + bed[0][0])  # the middle of a basin lies at x = 0
scene = ocean_sim.load(
    {
        "title": "A wave on a surveyed beach",
        "seed": 1,
        "duration": 7.0,
        "basin": {
            "length": length,
            "depth": depth,
            "floor": {"profile": [[x - middle, y] for x, y in bed], "friction_factor": 0.01},
            "wavemaker": {"kind": "solitary", "height": height},
        },
        "fluid": {"kind": "delta_sph", "spacing": 0.02},
        "gauges": {
            "every": 0.02,
            "elevation": {"offshore": [-1.2 - middle]},
            "runup": {"shore": {"along": "x"}},
        },
    }
)
print(scene.preflight.particles, "particles")
result = ocean_sim.run(scene, out="runs/beach", overwrite=True)

# %%
# `offshore_m` is the wave before it breaks; `shore_m` is the height of the highest wet place of the bed.

time, offshore, shore = (result.gauges[column] for column in ("time_s", "offshore_m", "shore_m"))
crest, highest = float(offshore.max()), float(np.nanmax(shore))
print(f"crest {crest:.3f} m offshore for {height:.3f} m asked; run-up {highest:.3f} m, {highest / depth:.2f} depths")
print(f"highest at {float(time[np.nanargmax(shore)]):.1f} s")

from matplotlib.figure import Figure

figure = Figure(figsize=(7.0, 4.0), layout="constrained")
wave, beach = figure.subplots(2, sharex=True)
wave.plot(time, offshore)
wave.set_ylabel("wave offshore [m]")
beach.plot(time, shore)
beach.axhline(highest, linestyle=":", label=f"run-up {highest:.3f} m")
beach.set(xlabel="time [s]", ylabel="water's edge [m]")
beach.legend()
figure.savefig("runs/a_wave_on_your_beach.png", dpi=150)
assert abs(crest - height) < 0.1 * height
assert 0.3 * depth < highest < 0.7 * depth

# %%
# How far is that to be trusted? The friction factor is the least certain number here: halve and double it. Finer
# particles follow the tongue of water further. To see a wave break, run the scene `gallery/beach`.
