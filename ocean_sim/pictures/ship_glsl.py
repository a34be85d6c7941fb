"""Paint and panes of a ship in the sun and under the sky, pixel by pixel: diffuse light, the shadow that she casts on
herself, a mirrored sky, the sun's highlight and the air between her and the eye. Colours follow `light.lit`."""

import numpy as np

from ocean_sim.pictures import light
from ocean_sim.pictures.water_glsl import number, vector
from ocean_sim.pictures.water_shading import EXPOSURE

TRAITS = "nrm", "col", "att"  # normal, paint, (gloss, share of the sky that is seen, 0)
PIXELS = 256  # of the shadow's map along a side
SAMPLES = 150_000  # points of her surface that cast it
SOFT = 1.5  # pixels of the map between the samples of a shadow on the water
NOTHING = -1e3  # depth where the sun sees none of her [m]
BIAS = 0.02  # of her length: less than that lies in no shadow of its own
DIRECTIONS, REACHES = 16, (0.6, 1.2, 2.0, 3.2)  # of rays to the sky, and how far they are followed [m]
CELL = 0.3  # [m] of the blocks that hide the sky
BRIGHTER = 1.15 / EXPOSURE  # of paint's light for the exposure of the sea
ROUGH = 0.012  # variance of the slopes of paint
COAT = 0.05  # reflectance of paint and panes at normal incidence

# The share of three by three pixels of the map that the sun sees, moved with the point, so that no pixel shows.
FUNCTIONS = f"""
float sunlit(vec3 p, vec3 n) {{
  vec3 q = p + {number(BIAS)} * shipLength * n - shipAt;
  vec2 at = {PIXELS}.0 * (0.5 + 0.5 * vec2(dot(q, sunRight), dot(q, sunUp)) / shipLength) - 0.5;
  vec2 first = floor(at), rest = at - first;
  float depth = dot(q, sunDir) + (2.5 - 1.5 * dot(n, sunDir)) * {number(BIAS)} * shipLength, open = 0.0;
  for (int i = -1; i <= 2; i++) {{
    float column = i < 0 ? 1.0 - rest.x : (i > 1 ? rest.x : 1.0);
    for (int j = -1; j <= 2; j++) {{
      float row = j < 0 ? 1.0 - rest.y : (j > 1 ? rest.y : 1.0);
      vec2 uv = (first + vec2(i, j) + 0.5) / {PIXELS}.0;
      open += column * row / 9.0 * step(textureLod(shade, uv, 0.0).r, depth);
    }}
  }}
  return open;
}}
"""

SHIP = f"""
  vec3 away = posW - eyeW;
  float dist = length(away);
  away /= dist;
  vec3 e = -away, n = normalize(nrmW);
  if (dot(n, e) < -0.3) n = -n;
  float sun = max(dot(n, sunDir), 0.0);
  if (sun > 0.0) sun *= sunlit(posW, n);
  vec3 above = mix({vector(light.FROM_BELOW)}, {vector(light.FROM_ABOVE)}, 0.5 + 0.5 * n.y) * attW.y;
  vec3 c = {number(BRIGHTER)} * colW * ({vector(light.SUNSHINE)} * sun + above) * (1.0 - 0.8 * attW.x);
  float ci = clamp(dot(n, e), 0.0, 1.0), share = {number(COAT)} + {number(1.0 - COAT)} * pow(1.0 - ci, 5.0);
  vec3 ray = 2.0 * dot(n, e) * n - e;
  vec3 seen = {number(BRIGHTER)} * {vector(light.FROM_BELOW)};
  if (ray.y > 0.0) seen = skyAt(normalize(ray), mix(5.0, 1.0, attW.x));
  c += share * mix(0.35, 1.6, attW.x) * attW.y * min(seen, vec3(3.0));
  vec3 h = normalize(sunDir + e);
  float c2 = max(dot(h, n), 0.001);
  c2 *= c2;
  float facets = exp(-(1.0 - c2) / (c2 * {number(2.0 * ROUGH)})) / ({number(2.0 * np.pi * ROUGH)} * c2 * c2);
  c += sunLight * {number(COAT)} * facets * 0.25 * sun;
  fragOutput0 = vec4(filmic(foggy(c, away, dist)), 1.0);
"""


def shadow(k: int, ships: int) -> str:
    """The program of the water for the shadow that ship k casts on it; the maps of all lie one over another."""
    return f"""
  vec3 off{k} = posW - shadeAt{k};
  vec2 cast{k} = 0.5 + 0.5 * vec2(dot(off{k}, sunRight), dot(off{k}, sunUp)) / shadeSize{k};
  bool inside{k} = all(greaterThan(cast{k}, shadeLow{k}.xy)) && all(lessThan(cast{k}, shadeHigh{k}.xy));
  int dark{k} = inside{k} && dot(off{k}, sunDir) < shadeHigh{k}.z ? 1 : 0;
  for (int turn = 0; turn < dark{k}; turn++) {{
    float depth = dot(off{k}, sunDir) + {number(BIAS)} * shadeSize{k};
    for (int i = -1; i <= 1; i++)
      for (int j = -1; j <= 1; j++) {{
        vec2 uv = cast{k} + {number(SOFT / PIXELS)} * vec2(i, j);
        sunlit -= step(depth, textureLod(shade, vec2(uv.x, ({k}.0 + uv.y) / {ships}.0), 0.0).r) / 9.0;
      }}
  }}
"""


class Shade:
    """What of a ship the sun does not see: depths along it, from points spread over her surface."""

    def __init__(self, corners: np.ndarray, length: float) -> None:
        """Triangles (m, 3, 3) in her axes [m]."""
        self.length = length
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        random = np.random.default_rng(1)
        which = np.searchsorted(np.cumsum(area) / area.sum(), random.random(SAMPLES))
        u, v = random.random((2, SAMPLES, 1))
        u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
        a, b, c = (corners[np.minimum(which, len(corners) - 1), k] for k in range(3))
        self.points = np.ascontiguousarray((a + u * (b - a) + v * (c - a)).T, np.float32)  # (3, SAMPLES)

    def map(self, turn: np.ndarray, sun: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(PIXELS, PIXELS, 3) depth [m] along the sun of what it sees around her position, and the directions of the
        map's columns and rows; `turn`: from her axes to the world's."""
        from scipy.ndimage import maximum_filter

        right = np.cross([0.0, 1.0, 0.0], sun)
        right /= np.linalg.norm(right)
        up = np.cross(sun, right)
        seen = (np.stack([right, up, sun]) @ turn).astype(np.float32) @ self.points
        column, row = np.clip((seen[:2] * (0.5 * PIXELS / self.length) + 0.5 * PIXELS).astype(np.int32), 0, PIXELS - 1)
        depth = np.full(PIXELS * PIXELS, NOTHING, np.float32)
        np.maximum.at(depth, row * PIXELS + column, seen[2])
        depth = maximum_filter(depth.reshape(PIXELS, PIXELS), 3)
        return np.repeat(depth[..., None], 3, axis=2), right, up


def cast(depth: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the shadow of a map of depths (PIXELS, PIXELS) [m] of a ship of a length [m] lies: its lowest and highest
    column and row, over the map's, and the farthest towards the sun [m] that anything lies in it."""
    row, column = np.nonzero(depth > NOTHING)
    reach = SOFT + 1.0  # pixels by which its edge is soft
    low, high = np.array([column.min(), row.min()]) - reach, np.array([column.max(), row.max()]) + 1.0 + reach
    farthest = float(depth.max()) - BIAS * length
    return np.append(low / PIXELS, 0.0), np.append(high / PIXELS, farthest)


def openness(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(n,) share of the sky that points (n, 3) [m] with normals (n, 3) of a ship see: her own parts hide the rest."""
    low = corners.min(axis=0) - CELL
    shape = np.ceil((corners.max(axis=0) - low) / CELL).astype(int) + 2
    full = np.zeros(shape, dtype=bool)
    triangles = corners.reshape(-1, 3, 3)
    for weights in np.random.default_rng(2).dirichlet(np.ones(3), 24):
        full[tuple(((np.einsum("k,mkx->mx", weights, triangles) - low) / CELL).astype(int).T)] = True
    turn = 2.0 * np.pi * np.arange(DIRECTIONS) * 0.381966
    rise = (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    rays = np.stack([np.sqrt(1 - rise**2) * np.cos(turn), rise, np.sqrt(1 - rise**2) * np.sin(turn)], axis=-1)
    start = corners + 1.2 * CELL * normals
    seen, weight = np.zeros(len(corners)), np.zeros(len(corners))
    for ray in rays:
        facing = np.maximum(normals @ ray, 0.0) + 0.15
        open_air = np.ones(len(corners), dtype=bool)
        for reach in REACHES:
            at = np.clip(((start + reach * ray - low) / CELL).astype(int), 0, shape - 1)
            open_air &= ~full[tuple(at.T)]
        seen, weight = seen + facing * open_air, weight + facing
    return 0.25 + 0.75 * seen / weight
