"""From a ship's motion to a platform, and over the wire to a rig.

A motion log goes through a washout to the six legs of a hexapod. The commands are streamed in real time. A receiver on
this machine stands in for the rig, and accepts only plausible packets.
"""

# %%
# A short voyage with a platform: `motion.csv` is what the ship does at her helm, `platform.csv` what the legs do.

import subprocess
import sys
from pathlib import Path
from time import sleep

import numpy as np

import ocean_sim

scene = ocean_sim.load(
    "ship_linear_sea",
    {
        "duration": 4.0,
        "platform": {"kind": "hexapod", "geometry": "hexapod_a", "washout": "ship"},
        "frames": None,
        "render": None,
        "report": None,
    },
)
result = ocean_sim.run(scene, out="runs/voyage", overwrite=True)
legs = result.table("platform")
lengths = np.stack([legs[f"leg{k}_m"] for k in range(1, 7)])
print(f"{lengths.shape[1]} commands; legs from {lengths.min():.2f} to {lengths.max():.2f} m")
assert np.isfinite(lengths).all()

from matplotlib.figure import Figure

figure = Figure(figsize=(7.0, 4.0), layout="constrained")
ride, commands = figure.subplots(2, sharex=True)
ride.plot(result.motion["time_s"], result.motion["heave_m"] - result.motion["heave_m"].mean())
ride.set_ylabel("heave of the ship [m]")
commands.plot(legs["time_s"], lengths.T)
commands.set(xlabel="time [s]", ylabel="legs of the platform [m]")
figure.savefig("runs/platform_and_rig.png", dpi=150)

# %%
# The same from any log, by hand: another washout, another geometry. The folder then also holds `metrics.csv`: what is
# felt, what was limited, and the motion sickness dose of ISO 2631-1 [m/s1.5], a third of which is about the percentage
# of people, not used to the sea, who would be sick.

COMMAND = [sys.executable, "-m", "ocean_sim"]
subprocess.run([*COMMAND, "platform", "runs/voyage", "--washout", "srs", "--out", "runs/srs"], check=True)
print(sorted(path.name for path in Path("runs/srs").glob("[!.]*")))
assert Path("runs/srs/platform.csv").is_file()

# %%
# Over the wire: start the receiver, then stream to it. A key that both sides have signs each packet; without it
# nothing moves. The receiver prints each pose that it accepts, and how many packets it turned away.

Path("rig.key").write_text("a secret of both sides")
address = "udp://127.0.0.1:5005"
receiver = subprocess.Popen(
    [sys.executable, "-u", "-m", "ocean_sim.platform.shared.datagrams", address, "rig.key"],
    stdout=subprocess.PIPE,
    text=True,
)
sleep(5.0)  # until it listens
stream = ["--stream", address, "--key", "rig.key", "--out", "runs/streamed"]
subprocess.run([*COMMAND, "platform", "runs/voyage", *stream], check=True)
said = receiver.communicate(timeout=120)[0].splitlines()  # it ends after 10 s of silence
print(said[-1])
assert " packets, 0 lost" in said[-1]

# %%
# On a rig, run the receiver on the machine that drives the legs. When packets stop coming it brakes within the limits
# of its legs, holds, and returns to neutral after 2 s. Poses begin from neutral, over a ramp.
