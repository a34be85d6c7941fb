"""Draws test planes with the water's program and saves their pixels: `python -m tests.pictures._shaded_plane OUT`.

The camera looks straight down in parallel projection, so that each pixel's place is known; the eye that the program is
told of is elsewhere.
"""

import sys

import numpy as np
import shading_reference as reference

from ocean_sim.pictures.stage import sky as sky_module
from ocean_sim.pictures.water import water_glsl

PIXELS, HALF = 48, 6.0  # pixels along a side, half a side [m]
CASES = {
    "all": reference.ShadingTerms(),
    "without Fresnel": reference.ShadingTerms(fresnel=False),
    "thesis's glint": reference.ShadingTerms(glint="thesis"),
    "no glint": reference.ShadingTerms(glint="none"),
    "body": reference.ShadingTerms(reflection=False, glint="none", fog=False),
    "mirror": reference.ShadingTerms(body=False, glint="none", foam=False, fog=False),
}
SUN = sky_module.unit_vector(np.array([-0.7, 0.5, 0.4]))
EYES = {"above": (40.0, 30.0, -30.0), "aslant": (-14.0, 6.0, 9.0), "grazing": (-300.0, 1.0, 200.0)}
VARIANCE, PIXEL = 0.004, 0.0004  # of slopes; angle of a pixel [rad]
FACES = {"+x": (1, 0, 0), "-x": (0, 1, 1), "+y": (0, 1, 0), "-y": (1, 0, 1), "+z": (0, 0, 1), "-z": (1, 1, 0)}


def positions() -> np.ndarray:
    """(PIXELS, PIXELS, 3) of the middles of the pixels, row 0 at the top of the picture."""
    side = (np.arange(PIXELS) + 0.5) / PIXELS * 2.0 * HALF - HALF
    x, z = np.meshgrid(side, side)
    return np.stack([x, np.zeros_like(x), z], axis=-1)


def normals(points: np.ndarray) -> np.ndarray:
    """Not of unit length: what interpolation between the corners of the plane gives."""
    return np.stack([0.05 * points[..., 0], np.ones(points.shape[:-1]), 0.05 * points[..., 2]], axis=-1)


def smooth_sky() -> sky_module.Sky:
    d = sky_module.sky_directions(128)
    image = np.stack([0.5 + 0.4 * d[..., 0], 0.5 + 0.3 * d[..., 2], 0.6 + 0.5 * d[..., 1]], axis=-1)
    return sky_module.Sky(image, SUN)


def six_colours() -> sky_module.Sky:
    d = sky_module.sky_directions(128)
    axis = np.abs(d).argmax(axis=-1)
    names = np.array([["+x", "-x"], ["+y", "-y"], ["+z", "-z"]])
    positive = np.take_along_axis(d, axis[..., None], axis=-1)[..., 0] > 0.0
    image = np.zeros(d.shape)
    for name, colour in FACES.items():
        image[names[axis, np.where(positive, 0, 1)] == name] = colour
    return sky_module.Sky(image, SUN)


def water(eye: np.ndarray, foam: float = 0.0) -> reference.Water:
    points = positions().reshape(-1, 3)
    away = points - eye
    distance = np.linalg.norm(away, axis=1)
    n = len(points)
    height, variance, white = np.full(n, 0.4), np.full(n, VARIANCE), np.full(n, foam)
    return reference.Water(
        sky_module.unit_vector(normals(points)), -away / distance[:, None], distance, height, variance, white
    )


def footprints(seen: reference.Water) -> np.ndarray:
    """(n,) of the pixels on the water [m], as the program has them."""
    slant = np.sqrt(np.maximum(reference.cosine(seen.to_eye, seen.normal), 0.06))
    return np.maximum(PIXEL * seen.distance / slant, 0.004)


def main(out: str) -> None:
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=(PIXELS, PIXELS), lighting="none")
    plotter.disable_anti_aliasing()
    plotter.render_window.SetMultiSamples(0)
    plotter.camera.position, plotter.camera.focal_point, plotter.camera.up = (0, 50, 0), (0, 0, 0), (0, 0, -1)
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = HALF
    plotter.camera.clipping_range = (1.0, 100.0)
    corners = np.array([[x, 0.0, z] for x in (-HALF, HALF) for z in (-HALF, HALF)], np.float32)
    mesh = pyvista.PolyData.from_regular_faces(corners, np.array([[0, 1, 2], [2, 1, 3]]))
    mesh.point_data["nrm"] = normals(corners).astype(np.float32)
    skies = {"smooth": smooth_sky(), "six": six_colours()}
    textures = {name: water_glsl.sky_textures(sky) for name, sky in skies.items()}
    none = water_glsl.make_texture(np.zeros((2, 2, 4), np.uint8))
    drawn = {}

    def draw(
        name: str, sky: str, eye: np.ndarray, terms: reference.ShadingTerms, foam: float = 0.0, ripples: float = 0.0
    ) -> None:
        mesh.point_data["att"] = np.tile(np.float32([foam, 0.4, VARIANCE]), (4, 1))
        inputs = textures[sky] | {"hull": none, "mirror": none}
        shaded = water_glsl.Shaded(
            mesh, water_glsl.water_program(0), water_glsl.WATER_FUNCTIONS, inputs, ("nrm", "att")
        )
        shaded.set(**water_glsl.neutral_uniforms(0) | water_glsl.sky_uniforms(skies[sky]) | terms.uniforms)
        shaded.set(eyeW=eye, rippleVariance=ripples, pixel=PIXEL)
        plotter.add_actor(shaded.actor, reset_camera=False, render=False, name="plane")
        plotter.render()
        drawn[name] = plotter.screenshot(None, return_img=True)

    for at, eye in EYES.items():
        for case, terms in CASES.items():
            draw(f"{case} {at}", "smooth", np.array(eye), terms)
    draw("ripples", "smooth", np.array(EYES["above"]), reference.ShadingTerms(), ripples=0.03)
    for share in (0.1, 0.3, 0.7):
        draw(f"foam {share}", "smooth", np.array(EYES["above"]), reference.ShadingTerms(glint="none"), foam=share)
    mirror = CASES["mirror"]
    for name, towards in (
        ("+x", (40, 2, 0)),
        ("-x", (-40, 2, 0)),
        ("+z", (0, 2, 40)),
        ("-z", (0, 2, -40)),
        ("+y", (0, 40, 0)),
    ):
        draw(f"six {name}", "six", np.array(towards, float) * [-1, 1, -1], mirror)
    np.savez(out, **drawn)
    plotter.close()


if __name__ == "__main__":
    main(sys.argv[1])
