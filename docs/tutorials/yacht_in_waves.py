"""A yacht in a random sea, and her response amplitude operator.

A sea in closed form needs no particles, so minutes of ship motion take seconds. First a yacht of 15 m sails in a
JONSWAP sea; then her heave in regular waves of several lengths gives the response amplitude operator (RAO).
"""

# %%
# The sea goes towards 180 degrees and the yacht heads along +z: a head sea. `free` leaves heave and pitch free, and
# holds all other motions.

import numpy as np

import ocean_sim

BASIN = {"length": 200.0, "width": 200.0, "depth": 40.0, "walls": "none"}
YACHT = {"kind": "yacht", "position": [0.0, 0.0], "free": ["heave", "pitch"]}
QUIET = {"frames": None, "render": None, "report": None, "accuracy": None}

spectrum = {"kind": "jonswap", "significant_wave_height": 0.8, "peak_period": 5.0, "heading_deg": 180.0, "seed": 7}
random_sea = ocean_sim.load(
    QUIET
    | {
        "duration": 40.0,
        "basin": BASIN,
        "fluid": {"kind": "linear_waves", "spectrum": spectrum},
        "ship": YACHT,
        "gauges": {"elevation": {"here": [0.0, 0.0]}},
    }
)
result = ocean_sim.run(random_sea, out="runs/random", overwrite=True)
later = result.motion["time_s"] > 10.0  # the sea has grown
print(f"significant heave {4.0 * result.motion['heave_m'][later].std():.2f} m in a sea of 0.8 m")

# %%
# Regular waves: the amplitude of heave over that of the wave. In long waves the yacht goes up and down with the water,
# and the ratio is 1; in waves shorter than she is, crests and troughs cancel along her hull.


def heave_ratio(period: float) -> float:
    """Amplitude of heave over that of a small regular wave, after eight periods."""
    scene = ocean_sim.load(
        QUIET
        | {
            "duration": 12.0 * period,
            "basin": BASIN,
            "fluid": {"kind": "linear_waves", "height": 0.1, "period": period, "heading_deg": 180.0},
            "ship": YACHT,
        }
    )
    motion = ocean_sim.run(scene, out=f"runs/regular_{period:g}", overwrite=True).motion
    settled = motion["time_s"] > 8.0 * period
    phase = 2.0 * np.pi * motion["time_s"][settled] / period
    wave = np.stack([np.cos(phase), np.sin(phase), np.ones_like(phase)], axis=1)
    (a, b, _), *_ = np.linalg.lstsq(wave, motion["heave_m"][settled], rcond=None)
    return float(np.hypot(a, b) / 0.05)


ratios = {period: heave_ratio(period) for period in (2.2, 3.5, 8.0)}
for period, ratio in ratios.items():
    print(f"period {period:g} s, wavelength {9.81 * period**2 / (2.0 * np.pi):.0f} m: heave {ratio:.2f} of the wave")
assert abs(ratios[8.0] - 1.0) < 0.1
assert ratios[2.2] < 0.5

from matplotlib.figure import Figure

figure = Figure(figsize=(7.0, 4.5), layout="constrained")
ride, operator = figure.subplots(2)
ride.plot(result.gauges["time_s"], result.gauges["here_m"], label="the sea where she starts")
ride.plot(result.motion["time_s"], result.motion["heave_m"] - result.motion["heave_m"][later].mean(), label="her heave")
ride.set(xlabel="time [s]", ylabel="[m]")
ride.legend(loc="upper left", ncols=2)
operator.plot(ratios.keys(), ratios.values(), "o-")
operator.set(xlabel="period of regular waves [s]", ylabel="heave over wave")
figure.savefig("runs/yacht_in_waves.png", dpi=150)

# %%
# `ocean-sim rao SCENE` gives all six motions from one run in an irregular sea, with their coherence.
# `ocean-sim validate ship_rao` compares such ratios with linear potential flow, for a barge and for Wigley's hull. For
# a hull of your own, begin with `ocean-sim hull FILE`.
