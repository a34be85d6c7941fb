"""Figure 6-5: one sea with and without Fresnel's share, white caps and the imitative HDR of the sun's glint, all eight
ways, and each term of the shading by itself; how bright each is: CSV and PNG.

A yacht on a closed-form sea with as much foam as Monahan & O'Muircheartaigh (1980) saw under a wind of WIND. Foam lies
in patches, and most views of this size have none near by: the yacht's PLACE is chosen, of places 4 m apart, as one with
a large patch before her. The caption tells the white share of the water nearer than the yacht, and of the sea. Without
Fresnel's, a constant share of the sky is mirrored. The HDR is the thesis's (3.16); the last row ends with all terms and
the physical glint (Cox & Munk 1954), which pictures have elsewhere. fig6_5_bare.png is the sea with nothing drawn that
the run does not know: no far sea, ripples, foam or scattered sky.

python figures/fig6_5.py [--fast] [--out DIR]
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from _kept import BARE, grey, run_frames, save_picture, take_pictures, view_rays
from _options import options, progress
from _paper import paper, save_figure, save_table

from ocean_sim.pictures.frame_files import Frame, FrameLog, frame_files
from ocean_sim.pictures.water.foam import monahan_cover, white_shares

WIND = 14.0  # [m/s]
PLACE = (4.0, 32.0)  # x, z of the yacht [m]
SCENE: dict[str, Any] = {
    "title": "figure 6-5",
    "seed": 7,
    "duration": 8.0,
    "basin": {"length": 160.0, "width": 160.0, "depth": 30.0, "walls": "none"},
    "fluid": {
        "kind": "linear_waves",
        "ramp": 0.0,
        "spectrum": {
            "kind": "jonswap",
            "significant_wave_height": 1.5,
            "peak_period": 5.5,
            "heading_deg": 150.0,
            "seed": 7,
        },
    },
    "ship": {"kind": "yacht", "position": list(PLACE)},
    "frames": {"every": 0.5, "spacing": 2.0},
}
VIEW = {"camera": "fixed", "eye": (28.0, 5.0, 38.0), "target": (0.0, 0.6, 28.0)}  # towards the sun, over the yacht
SWITCHES: list[dict[str, Any]] = [
    {"fresnel": fresnel, "foam": foam, "glint": glint}
    for glint in ("none", "thesis")
    for foam in (False, True)
    for fresnel in (False, True)
]
NOTHING: dict[str, Any] = {"reflection": False, "body": False, "glint": "none", "foam": False}
TERMS: dict[str, dict[str, Any]] = {
    "light from within (3.12, 3.13)": NOTHING | {"body": True},
    "mirrored sky (3.6), (3.8)": NOTHING | {"reflection": True},
    "white caps": NOTHING | {"foam": True},
    "all terms, physical glint": {},
}
BRIGHT = 0.6  # luminance from which a pixel of the water is glint
APART = 0.01  # of luminance: what a switch has changed


def title(switch: dict) -> str:
    marks = ("Fresnel", switch["fresnel"]), ("white caps", switch["foam"]), ("HDR", switch["glint"] == "thesis")
    return ", ".join(f"{'with' if on else 'no'} {name}" for name, on in marks)


def white_before_yacht(run: Path, cover: float) -> float:
    """White share of the pixels of still water nearer than the yacht at the end of a run, foam being on a share `cover`
    of the sea."""
    log = FrameLog(frame_files(run))
    foam = Frame(log.nearest(SCENE["duration"])).foam
    assert foam is not None
    eye, rays = view_rays(VIEW, 16 / 9, 90)
    ways = -eye[1] * rays[rays[:, 1] < 0.0] / rays[rays[:, 1] < 0.0][:, 1:2]
    near = ways[np.hypot(ways[:, 0], ways[:, 2]) < np.hypot(*(eye[[0, 2]] - PLACE))]
    sides = np.array([SCENE["basin"][side] for side in ("length", "width")])
    at = ((eye + near)[:, [0, 2]] / sides + 0.5) * foam.shape
    return float(white_shares(foam, cover)[tuple(at.astype(int).T)].mean())


def main() -> None:
    asked = options(__doc__, "small pictures")
    size = (320, 180) if asked.fast else (960, 540)
    with TemporaryDirectory() as place:
        progress(0.0, "a yacht in a sea")
        run = run_frames(SCENE, Path(place, "run"))
        progress(0.3, "pictures of it")
        view = VIEW | {"size": size, "quality": "draft" if asked.fast else "final"}
        cover = monahan_cover(WIND)
        before = white_before_yacht(run, cover)
        orders = [*SWITCHES, *TERMS.values(), BARE]
        pictures = take_pictures(run, SCENE["duration"], orders, foam_cover=cover, **view)
    save_picture(asked.out / "fig6_5_bare.png", pictures[-1])
    names = [title(switch) for switch in SWITCHES] + list(TERMS)
    water = slice(int(0.45 * size[1]), None)  # below the horizon
    rows = []
    for name, order, picture in zip(names, orders, pictures):
        light = grey(picture[water])
        foamless = order | {"foam": False}
        twin = pictures[orders.index(foamless)] if foamless in orders else None
        white = (
            float((np.abs(light - grey(twin[water])) > APART).mean()) if twin is not None and name not in TERMS else ""
        )
        rows.append((name, float(light.mean()), float(light.std()), float((light > BRIGHT).mean()), white))
    head = [f"luminance 0 to 1 (Rec. 709) of the lower part of pictures of {size[0]} x {size[1]} pixels"]
    head += [f"foam asked for: {cover:.4f} of the sea, the share at {WIND:g} m/s (Monahan & O'Muircheartaigh 1980)"]
    head += [f"white share of the water nearer than the yacht: {before:.3f}"]
    columns = ["picture", "mean_luminance", "deviation", "share_of_glint", "share_changed_by_foam"]
    save_table(asked.out / "fig6_5.csv", head, columns, rows)
    figure = paper(16.0, 7.6)
    axes = figure.subplots(3, 4)
    for axis, name, picture, row in zip(axes.ravel(), names, pictures, rows):
        axis.imshow(picture)
        axis.set_title(f"{name}\nluminance {row[1]:.3f}, glint {100 * row[3]:.2f} %", fontsize=9)
        axis.set_axis_off()
    found = f"At this chosen place {100 * before:.0f} % of the water nearer than the yacht is white"
    save_figure(figure, asked.out / "fig6_5.png", f"{found}, of the whole sea {100 * cover:.1f} %")
    progress(1.0, "done")


if __name__ == "__main__":
    main()
