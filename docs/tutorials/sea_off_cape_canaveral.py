"""The sea off Cape Canaveral, and a yacht in it.

A spectrum such as JONSWAP is a sea as it should be; a buoy measures one as it was. Here a scene takes the waves that
NDBC's buoy 41010, 120 nautical miles east of Cape Canaveral, measured on 2 June 2020, and a yacht meets them.
"""

# %%
# The packaged scene `cape_canaveral` names the file of the buoy. A buoy's file has rows for many times, so the scene
# also names the time; `ocean-sim sea scenes/41010.data_spec` lists all.

import numpy as np

import ocean_sim

QUIET = {"frames": None, "render": None, "report": None, "accuracy": None}
scene = ocean_sim.load("cape_canaveral", QUIET)
sea = ocean_sim.wave_field(scene).sea
print(f"{len(sea.amplitude)} plane waves, significant height {sea.significant_height:.2f} m")
assert abs(sea.significant_height - 2.744) < 0.005 * 2.744

# %%
# The file says from where waves come, clockwise from north. In the world north is +z, and since its axes are
# right-handed, with y up, east is -x; `north_deg` turns north elsewhere. `check` states this.

(note,) = (note for note in scene.notes if "41010" in note)
print(note)
assert "north is +z, east is -x" in note

# %%
# In this sea long waves come from further north than short ones: `ocean-sim sea` finds a swell of 1.7 m from 11 degrees
# and wind seas from 77 and 63 degrees. Each wave travels to where its wavevector points, so those that come from the
# north have a negative z, and those from the east a positive x.

energy = sea.amplitude**2
long = sea.omega < 2.0 * np.pi / 8.0
from_north, from_east = -sea.wavevector[:, 1] / sea.wavenumber, sea.wavevector[:, 0] / sea.wavenumber
for name, some in (("longer than 8 s", long), ("shorter than 8 s", ~long)):
    north, east = (np.average(way[some], weights=energy[some]) for way in (from_north, from_east))
    print(f"waves {name} come from {np.degrees(np.arctan2(east, north)):.0f} degrees")
assert np.average(from_north[long], weights=energy[long]) > np.average(from_north[~long], weights=energy[~long])

# %%
# Let the yacht drift in it for a minute. Gauges stand in the same waves.

result = ocean_sim.run(scene, out="runs/cape_canaveral", overwrite=True)
grown = result.gauges["time_s"] > 20.0  # the sea grows over two periods of its highest waves
print(f"the level at the centre varies by {np.ptp(result.gauges['centre_m'][grown]):.1f} m")
print(f"she heaves by {np.ptp(result.motion['heave_m'][result.motion['time_s'] > 20.0]):.1f} m")
assert 1.0 < np.ptp(result.gauges["centre_m"][grown]) < 2.0 * 2.744

from matplotlib.figure import Figure

figure = Figure(figsize=(7.0, 4.5), layout="constrained")
waves, ride = figure.subplots(2)
origin = np.degrees(np.arctan2(from_east, from_north)) % 360.0
waves.scatter(2.0 * np.pi / sea.omega, origin, s=60.0 * energy / energy.max(), alpha=0.5)
waves.set(xlabel="period [s]", ylabel="comes from [degrees]", title="plane waves of the buoy, by energy")
ride.plot(result.gauges["time_s"], result.gauges["centre_m"], label="level at the centre")
ride.plot(result.motion["time_s"], result.motion["heave_m"] - result.motion["heave_m"].mean(), label="her heave")
ride.set(xlabel="time [s]", ylabel="[m]")
ride.legend()
figure.savefig("runs/sea_off_cape_canaveral.png", dpi=150)

# %%
# The same keys take files of CDIP, Spotter, SWAN, WAVEWATCH III and ERA5, and they go into `spectral_sea` and into the
# sea around particles, too.
