"""Water that folds over, in a tank of glass: clear, with splashes of its own.

Things behind clear water are seen bent and dimmed by the way of light through it. Two pictures come first: one of
everything but the water, one of the distances of its back faces. The shader takes the difference of both faces as the
thickness, absorbs and scatters along it (Beer and Lambert), and mirrors the sky. Water hidden by other water, as a pool
below a jet, is drawn first, behind the back faces of the nearer one.
"""

from typing import Any

import numpy as np

from ocean_sim.pictures.frame_files import Frame, kept_ground
from ocean_sim.pictures.stage import sky
from ocean_sim.pictures.stage.plotter import Content, Stage
from ocean_sim.pictures.water import splash as splashing
from ocean_sim.pictures.water import tank_walls, water_glsl, water_shading
from ocean_sim.pictures.water.smoothed_mesh import points_on_sides, smooth_mesh
from ocean_sim.pictures.water.water_glsl import number, vector
from ocean_sim.surface import Mesh

TANK_EXPOSURE = 1.15  # of water in a tank, as of what is drawn with plain colours
MAX_SMOOTHING = 0.4  # [spacings] by which a folded surface is smoothed
BEHIND_GLASS = np.array([0.0, 0.0, 0.0])  # air that is seen of it, holes, wrinkles: glass is smooth
WATER_TRAITS = "nrm", "air", "was"  # normal; air, how torn, how rough; where its water was born
ABSORPTION = np.array([3.0, 0.85, 0.60])  # of light, in a way as long as the tank is deep
# Light that comes back from water so thick that nothing shines through
SCATTERED_LIGHT = np.array([0.016, 0.135, 0.170])
SHINE_VARIANCE = 0.004  # variance of slopes that widen the sun's highlight
RELIEF_FACTOR = 1.6  # by which slopes are steeper than they are in the light of a map
GRAIN_LENGTH = 0.5  # of foam: how many of its metres on a sea a spacing of the particles is in a tank
# [1/spacing] of two scales, and how far each tilts a skin that is stirred
WRINKLE_SCALES, WRINKLE_SLOPES = (0.55, 1.5), (0.40, 0.30)
HEIGHT_SKEW = (0.7, 0.4)  # of the height at which water was born, in the two coordinates of its grain
HOLE_SHARE = 1.15  # share of a skin that is gone where it is wholly torn, over 1
# Colour of water full of bubbles; its light from all sides, and the sun's
FOAM_COLOUR, FOAM_LIGHTS = np.array([0.80, 0.83, 0.84]), (0.62, 0.38)

DEPTH_FUNCTIONS = """
vec3 from(vec3 p) { return mix(p - eyeW, ahead * dot(p - eyeW, ahead), parallel); }
float measured(vec4 met) { return (met.r * 255.0 + met.g) / 255.0; }
bool isBehind(float dist, ivec2 here) {
  vec4 nearer = texelFetch(before, here, 0);
  return behindOthers < 0.5 || dist / reach > (nearer.a > 0.5 ? measured(nearer) + 0.0005 : 2.0);
}
"""  # the way from the eye, in parallel projection from its plane; and which water other water hides

DISTANCE_PROGRAM = """
  float dist = length(from(posW));
  if (!isBehind(dist, ivec2(gl_FragCoord.xy))) discard;
  float far = clamp(dist / reach, 0.0, 1.0) * 255.0;
  fragOutput0 = vec4(floor(far) / 255.0, fract(far), 0.0, 1.0);
"""

GRAIN_FUNCTIONS = f"""
vec2 grainAt(vec3 was) {{
  vec3 q = was / spacing;
  return vec2(q.x + {number(HEIGHT_SKEW[0])} * q.y, q.z - {number(HEIGHT_SKEW[1])} * q.y);
}}
vec3 wrinkled(vec3 n, vec2 q, float footprint, float rough) {{
  const vec2 scales = vec2({number(WRINKLE_SCALES[0])}, {number(WRINKLE_SCALES[1])});
  const vec2 steep = vec2({number(WRINKLE_SLOPES[0])}, {number(WRINKLE_SLOPES[1])});
  vec3 tilt = vec3(0.0);
  for (int o = 0; o < 2; o++) {{
    float fine = clamp(1.5 - 3.0 * footprint * scales[o], 0.0, 1.0);
    vec2 p = scales[o] * q;
    tilt += fine * steep[o] * (vec3(noise(p + 11.0).x, noise(p + 37.0).x, noise(p + 71.0).x) - 0.5);
  }}
  return normalize(n + rough * tilt);
}}
"""

WATER_PROGRAM = f"""
  vec3 away = from(posW);
  float dist = length(away);
  away /= dist;
  ivec2 here = ivec2(gl_FragCoord.xy * vec2(textureSize(back, 0)) / screen.xy);
  if (!isBehind(dist, here)) discard;
  vec3 e = -away, n = normalize(nrmW);
  if (dot(n, e) < 0.0) n = -n;
  vec2 q = grainAt(wasW);
  float footprint = pixel * mix(dist, 1.0, parallel) / spacing;
  float airy = clamp(airW.x, 0.0, 1.0), torn = clamp(airW.y, 0.0, 1.0), rough = clamp(airW.z, 0.0, 1.0);
  if (torn > 0.02 && noise(0.8 * q + 3.0).x * 0.6 + noise(2.1 * q).x * 0.4 <
      {number(HOLE_SHARE)} * torn - 0.15) discard;
  if (rough > 0.01) {{
    n = wrinkled(n, q, footprint, rough);
    float turned = 0.03 - dot(n, e);
    if (turned > 0.0) n = normalize(n + e * turned);
  }}
  vec4 exit = texelFetch(back, here, 0);
  float thick = exit.a > 0.5 ? max(measured(exit) * reach - dist, 0.0) : 0.0;
  vec3 down = refract(away, n, {number(1.0 / water_shading.REFRACTIVE_INDEX)});
  vec3 onwards = step(vec3(0.0), down);
  vec3 ends = (mix(boxLow, boxHigh, onwards) - posW) / (down + mix(vec3(-1e-6), vec3(1e-6), onwards));
  thick = min(thick, max(min(ends.x, min(ends.y, ends.z)), 0.0));
  vec4 at = view * vec4(posW + thick * down, 1.0);
  vec3 behind = radiance(min(textureLod(scene, clamp(0.5 + 0.5 * at.xy / at.w, 0.002, 0.998), 0.0).rgb, vec3(1.0)));
  thick /= depth;
  vec3 left = exp(-{vector(ABSORPTION)} * thick);
  float share = fresnel(clamp(dot(n, e), 0.02, 1.0));
  float lit = 0.55 + 0.45 * clamp(dot(n, sunDir), -0.4, 1.0);
  vec3 ray = reflect(away, n);
  vec3 over = ray.y > 0.0 ? min(skyAt(ray, 2.0), vec3(1.4)) : 0.45 * {vector(sky.HORIZON_COLOUR)};
  vec3 c = (behind * left + {vector(SCATTERED_LIGHT)} * lit * (1.0 - left)) * (1.0 - share) + over * share;
  vec3 h = normalize(sunDir + e);
  float c2 = max(dot(h, n), 0.001);
  c2 *= c2;
  c += {vector(sky.SUNLIGHT_COLOUR)} * min(0.5 * share * exp(-(1.0 - c2) / (c2 * {number(2.0 * SHINE_VARIANCE)})) /
    ({number(2.0 * np.pi * SHINE_VARIANCE)} * c2 * c2), 2.5);
  float foamy = white(airy, {number(GRAIN_LENGTH)} * q, {number(GRAIN_LENGTH)} * footprint);
  if (foamy > 0.0) {{
    vec3 heap = heaps({number(GRAIN_LENGTH)} * q, {number(GRAIN_LENGTH)} * footprint);
    float bright = {number(FOAM_LIGHTS[0])} +
      {number(FOAM_LIGHTS[1])} * max(dot(n, sunDir) + 0.2 * (heap.x + heap.y), 0.0);
    c = mix(c, {vector(FOAM_COLOUR)} * bright * (1.0 + foamy * (heap.z - 1.0)), foamy);
  }}
  vec2 slope = {number(RELIEF_FACTOR)} * n.xz / max(n.y, 0.05);
  slope /= sqrt(1.0 + dot(slope, slope) / {number(water_shading.MAP_STEEPEST**2)});
  float hill = max(dot(normalize(vec3(slope.x, 1.0, slope.y)), {vector(water_shading.MAP_LIGHT)}), 0.0);
  fragOutput0 = vec4(filmic(c * mix(1.0, 0.3 + 1.12 * hill, onMap)), 1.0);
"""


class Shell(Content):
    """Closed surface of the water in a glass tank, drawn smooth and clear, with drops."""

    def __init__(self, stage: Stage, grid: Any, upper: np.ndarray, first: Frame, white: bool) -> None:
        """`grid`: arrays that frames keep once; `upper`: top corner of the drawn tank [m]; `first`: first frame of the
        run; `white`: True to draw splashes."""
        depth = self.depth = float(grid["depth"])
        self.stage, self.first, self.white = stage, first, white
        self.lower, self.upper, self.spacing = tuple(grid["lower"]), tuple(upper), float(grid["spacing"])
        self.sides = grid["lower"][[0, 2]], grid["upper"][[0, 2]]
        self.boxes, self.ground = grid.get("obstacles", np.zeros((0, 2, 3))), kept_ground(grid)
        tank_walls.add_tank(stage, grid["lower"], upper, depth)
        over = sky.clear_sky_image()
        ball = stage.pyvista.Icosphere(radius=1.0, nsub=1)
        directions = np.asarray(ball.points, dtype=float)
        self.ball = Mesh(directions, ball.regular_faces, directions)
        self.behind = water_glsl.make_texture(np.zeros((2, 2, 3), np.uint8))
        self.far, self.farther = (water_glsl.make_texture(np.zeros((2, 2, 4), np.uint8)) for _ in range(2))
        textures = water_glsl.sky_textures(over)
        seen = textures | {"scene": self.behind, "back": self.farther, "before": self.far}
        functions = water_glsl.WATER_FUNCTIONS + DEPTH_FUNCTIONS + GRAIN_FUNCTIONS
        plain = water_glsl.neutral_uniforms(0) | water_glsl.sky_uniforms(over)
        self.water = water_glsl.Shaded(stage.pyvista.PolyData(), WATER_PROGRAM, functions, seen, WATER_TRAITS)
        measured = water_glsl.own_textures(textures | {"before": self.far})
        self.backs = water_glsl.Shaded(self.water.mesh, DISTANCE_PROGRAM, functions, measured, WATER_TRAITS)
        self.backs.actor.GetProperty().FrontfaceCullingOn()
        half, parallel = stage.camera.parallel_height, stage.camera.parallel_height is not None
        pixel = 2.0 * (half or float(np.tan(np.radians(stage.camera.angle) / 2.0))) / (stage.samples * stage.size[1])
        for part in (self.water, self.backs):
            shown: dict[str, Any] = {
                "exposure": TANK_EXPOSURE,
                "depth": depth,
                "reach": 1.0,
                "onMap": float(stage.camera.from_above),
            }
            shown |= {"spacing": self.spacing, "pixel": pixel, "behindOthers": 0.0, "parallel": float(parallel)}
            shown |= {"ahead": stage.camera.forward}
            shown |= {"boxLow": np.array(self.lower), "boxHigh": np.array(self.upper)}
            part.set(**plain | shown | {"view": np.eye(4), "screen": np.ones(3)})
        stage.plotter.add_actor(self.water.actor, reset_camera=False, render=False)
        self.measure = stage.empty(stage.plotter.window_size)  # the picture of distances
        self.measure.set_background("black")
        self.measure.add_actor(self.backs.actor, reset_camera=False, render=False)

    def surface(self, frame: Frame) -> tuple[Mesh, np.ndarray, np.ndarray]:
        """Surface mesh of a frame, and at its vertices traits (n, 3): shares of air, tearing and roughness; and the
        places (n, 3) [m] at which their water was in the first frame (see WATER_TRAITS)."""
        assert frame.mesh is not None
        skin = smooth_mesh(Mesh(*frame.mesh), self.lower, self.upper, MAX_SMOOTHING * self.spacing)
        particles, start = (frame.position, frame.velocity, frame.id), (self.first.position, self.first.id)
        if not self.white or any(each is None for each in (*particles, *start)) or not len(skin.vertices):
            return skin, np.zeros_like(skin.vertices), skin.vertices
        position, velocity, number = (np.asarray(each) for each in particles)
        position, velocity = position.astype(float), velocity.astype(float)
        bed = self.lower[1] if self.ground is None else self.ground.heights(position[:, [0, 2]])
        floor = splashing.floor_heights(position, bed, self.boxes)
        low, cell = self.sides[0], (self.sides[1] - self.sides[0]) / frame.elevation.shape
        up = np.maximum(
            splashing.flying_share(position, floor, self.spacing),
            splashing.risen_share(position, frame.elevation, low, cell, self.spacing),
        )
        birth = splashing.birth_places(position, number, np.asarray(start[0], float), np.asarray(start[1]))
        up *= splashing.travel_share(position, number, birth, np.asarray(start[1]), self.spacing)
        beside = np.abs(position[:, None, [0, 2]] - np.stack(self.sides)) < self.spacing
        found = splashing.particle_splash(position, velocity, up, beside.sum(axis=(1, 2)), self.spacing, self.depth)
        known = np.column_stack([found.air, found.torn, found.rough, birth])
        traits = splashing.values_at_vertices(skin.vertices, position, known, self.spacing)
        on = points_on_sides(skin.vertices, self.lower, self.upper).any(axis=(0, 2))
        traits[on, :3] *= BEHIND_GLASS
        middles, radii = splashing.torn_drops(position, velocity, number, found.torn, self.spacing)
        inside = np.all((middles > self.lower) & (middles < self.upper), axis=1)
        balls = splashing.sphere_mesh(middles[inside], radii[inside], self.ball)
        n = len(skin.vertices)
        whole = Mesh(
            np.concatenate([skin.vertices, balls.vertices]),
            np.concatenate([skin.triangles, balls.triangles + n]),
            np.concatenate([skin.normals, balls.normals]),
        )
        calm = np.zeros_like(balls.vertices)
        return whole, np.concatenate([traits[:, :3], calm]), np.concatenate([traits[:, 3:], balls.vertices])

    def show(self, frame: Frame) -> None:
        """Update the surface to a frame, and render the pictures of distances and background that its shader needs."""
        mesh, state, birth = self.surface(frame)
        traits = dict(zip(WATER_TRAITS, (mesh.normals, state, birth), strict=True))
        self.water.mesh.DeepCopy(self.stage.mesh(mesh.vertices, mesh.triangles, **traits))
        eye, plotter = self.stage.camera.eye, self.stage.plotter
        reach = 1.01 * float(np.linalg.norm(mesh.vertices - eye, axis=1).max())
        camera = plotter.camera
        view = water_glsl.projection(camera, self.stage.size[0] / self.stage.size[1])
        screen = np.array([*plotter.window_size, 1.0])
        for part in (self.water, self.backs):
            part.set(eyeW=eye, ahead=self.stage.camera.forward, reach=reach, view=view, screen=screen, behindOthers=0.0)
        self.measure.camera.DeepCopy(camera)
        nearest = self.distances()
        water_glsl.fill_image(self.far.GetInput(), nearest)
        self.backs.set(behindOthers=1.0)
        water_glsl.fill_image(self.farther.GetInput(), self.distances())
        self.water.actor.VisibilityOff()
        self.see()
        self.water.actor.VisibilityOn()
        self.water.set(behindOthers=1.0)
        self.see()
        self.water.set(behindOthers=0.0)
        water_glsl.fill_image(self.farther.GetInput(), nearest)

    def distances(self) -> np.ndarray:
        """Distances of the water's back faces as an image (height, width, 4), lowest row first."""
        self.measure.render()
        return self.measure.screenshot(None, return_img=True, transparent_background=True)[::-1]

    def see(self) -> None:
        """Render the present picture, and use it as the background seen through the water."""
        for mark in self.stage.over:
            mark.VisibilityOff()
        self.stage.plotter.render()
        for mark in self.stage.over:
            mark.VisibilityOn()
        water_glsl.fill_image(self.behind.GetInput(), self.stage.plotter.screenshot(None, return_img=True)[::-1])

    def close(self) -> None:
        """Close the plotter in which distances through the water are drawn."""
        self.measure.close()
