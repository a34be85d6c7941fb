"""Formulas of `water_shading`, `ripples` and `foam` for a graphics processor, as replacements in VTK's shaders.

Numbers come from those files, so that each law is written once; the tests compare the colours. Traps of VTK: it
declares uniforms and samplers itself; a mistake in a shader only logs and draws nothing (see `refusal`). Mesa's
processor in software computes both sides of every `if`, but leaves a loop as soon as no pixel of a group goes on: code
for few pixels is a loop of one turn or none.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ocean_sim.pictures.stage.sky import HAZE_SIZE, MIN_SKY_HEIGHT, Sky
from ocean_sim.pictures.water import foam, ripples
from ocean_sim.pictures.water import water_shading as w

# Coefficients of the ratio of polynomials of a root that is x^(1/2.2): see the test
GAMMA_POLYNOMIAL = (0.0319, 0.8804, 0.8577, 0.0193, 0.7503)
CONSTANT_REFLECTANCE = 0.4  # share of the mirrored sky where Fresnel's is switched off
GLINTS = {"none": 0.0, "physical": 1.0, "thesis": 2.0}  # of the sun, as the program numbers them


def number(value: float) -> str:
    """GLSL literal of a float, with a decimal point or an exponent."""
    return f"{float(value):.9g}" if "." in f"{float(value):.9g}" or "e" in f"{float(value):.9g}" else f"{value:.1f}"


def vector(values: Iterable[float]) -> str:
    """GLSL literal of a vec3."""
    return f"vec3({', '.join(number(v) for v in values)})"


COMMON_FUNCTIONS = f"""
vec3 skyAt(vec3 d, float level) {{
  d = normalize(vec3(d.x, max(d.y, {number(MIN_SKY_HEIGHT)}), d.z));
  return textureLod(sky, 0.5 + 0.5 * d.xz / (1.0 + d.y), level).rgb;
}}
vec3 filmic(vec3 c) {{
  c = max(c, vec3(0.0)) * exposure;
  c = c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14);
  vec3 s = sqrt(clamp(c, 0.0, 1.0));
  return s * ({number(GAMMA_POLYNOMIAL[0])} + s * ({number(GAMMA_POLYNOMIAL[1])} + {number(GAMMA_POLYNOMIAL[2])} * s)) /
         ({number(GAMMA_POLYNOMIAL[3])} + s * ({number(GAMMA_POLYNOMIAL[4])} + s));
}}
vec3 radiance(vec3 shown) {{
  vec3 y = min(pow(shown, vec3(2.2)), vec3(0.98));
  vec3 a = 2.51 - 2.43 * y, b = 0.03 - 0.59 * y;
  return (sqrt(b * b + 0.56 * a * y) - b) / (2.0 * a * exposure);
}}
"""

# The haze is fetched from a fine row around the horizon, in less time than it is found in the sky.
FOG_FUNCTIONS = f"""
vec3 foggy(vec3 c, vec3 away, float dist) {{
  float f = 1.0 - exp(-dist / fogReach);
  f *= 0.5 + 0.5 * f * (3.0 - 2.0 * f);
  f = mix(f, 1.0, smoothstep({number(w.FOG_END[0])}, {number(w.FOG_END[1])}, dist / fogReach));
  float ahead = away.x / max(abs(away.x) + abs(away.z), 1e-6);
  float at = away.z < 0.0 ? 3.0 + ahead : 1.0 - ahead;
  int k = int({number(HAZE_SIZE[0] * HAZE_SIZE[1] / 4)} * at) % {HAZE_SIZE[0] * HAZE_SIZE[1]};
  return mix(c, texelFetch(haze, ivec2(k % {HAZE_SIZE[1]}, k / {HAZE_SIZE[1]}), 0).rgb, f * useFog);
}}
"""

WATER_FUNCTIONS = f"""{FOG_FUNCTIONS}
float refracted(float ci) {{ return sqrt(1.0 - (1.0 - ci * ci) / {number(w.REFRACTIVE_INDEX**2)}); }}
float fresnel(float ci) {{
  const float n = {number(w.REFRACTIVE_INDEX)};
  float ct = refracted(ci), rs = (ci - n * ct) / (ci + n * ct), rp = (n * ci - ct) / (n * ci + ct);
  return 0.5 * (rs * rs + rp * rp);
}}
float chance(ivec2 p) {{
  uint n = uint(p.x) * 374761393u + uint(p.y) * 668265263u;
  n = (n ^ (n >> 13u)) * 1274126177u;
  return float(n >> 16u) * {number(1 / 65535)};
}}
vec3 noise(vec2 p) {{
  vec2 w = floor(p), f = p - w;
  ivec2 i = ivec2(w);
  vec2 u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0), du = 30.0 * f * f * (f * (f - 2.0) + 1.0);
  float a = chance(i), b = chance(i + ivec2(1, 0)), c = chance(i + ivec2(0, 1)), d = chance(i + ivec2(1, 1));
  float k = a - b - c + d;
  return vec3(a + (b - a) * u.x + (c - a) * u.y + k * u.x * u.y, du * (vec2(b - a, c - a) + k * u.yx));
}}
float patches(vec2 q) {{
  q *= {number(foam.GRAIN_SCALE)};
  q += {number(foam.GRAIN_BEND)} * (vec2(noise(0.6 * q + vec2(3.0, 7.0)).x, noise(0.6 * q + vec2(23.0, 11.0)).x) - 0.5);
  float grain = 0.42 * noise(0.45 * q).x, scale = 1.3;
  vec3 shares = vec3(0.30, 0.26, 0.20);
  for (int o = 0; o < 3; o++) {{
    q = vec2({number(foam.OCTAVE_TURN[0])} * q.x - {number(foam.OCTAVE_TURN[1])} * q.y,
             {number(foam.OCTAVE_TURN[1])} * q.x + {number(foam.OCTAVE_TURN[0])} * q.y);
    float ridge = 1.0 - abs(2.0 * noise(scale * q + 9.0).x - 1.0);
    grain += shares[o] * ridge * ridge;
    scale *= 2.1;
  }}
  return grain;
}}
float white(float share, vec2 q, float footprint) {{
  float fine = clamp(1.0 - footprint / {number(foam.MAX_FOOTPRINT)}, 0.0, 1.0);
  float result = share > {number(foam.MIN_SHARE)} ? share : 0.0;
  int turns = result > 0.0 && fine > 0.0 ? 1 : 0;
  for (int turn = 0; turn < turns; turn++) {{
    float rank = 1.0 / (1.0 + exp(1.702 * (patches(q) - {number(foam.PATCH_MEAN)}) / {number(foam.PATCH_DEVIATION)}));
    float whiter = {number((1 - foam.MIN_WHITENESS) / foam.WHOLE_SHARE)} * share;
    float thick = min({number(foam.MIN_WHITENESS)} + whiter, 1.0);
    float covered = share / thick, soft = max(min(min(covered, 1.0 - covered), {number(foam.EDGE_SOFTNESS)}), 0.001);
    float edge = clamp((covered + soft - rank) / (2.0 * soft), 0.0, 1.0);
    result = mix(share, thick * edge * edge * (3.0 - 2.0 * edge), fine);
  }}
  return result;
}}
vec3 heaps(vec2 q, float footprint) {{
  vec2 turned = vec2({number(foam.OCTAVE_TURN[0])}, {number(foam.OCTAVE_TURN[1])}), way = turned;
  vec3 scales = {vector(foam.HEAP_SCALES)}, depths = {vector(foam.HOLLOW_SHADES)}, found = vec3(0.0, 0.0, 1.0);
  for (int o = 0; o < 3; o++) {{
    float fine = clamp(1.5 - 3.0 * footprint * scales[o], 0.0, 1.0);
    vec3 a = noise(scales[o] * vec2(way.x * q.x - way.y * q.y, way.y * q.x + way.x * q.y) + 5.0);
    found.x += {number(foam.HEAP_SLOPE)} * fine * (way.x * a.y + way.y * a.z);
    found.y += {number(foam.HEAP_SLOPE)} * fine * (way.x * a.z - way.y * a.y);
    found.z += depths[o] * fine * (a.x - 0.5);
    way = vec2(way.x * turned.x - way.y * turned.y, way.y * turned.x + way.x * turned.y);
  }}
  return found;
}}
vec3 ripples(vec2 p, float footprint) {{
  float c = cos(windAngle), s = sin(windAngle), wave = rippleLongest;
  float lost = {number(ripples.UNRESOLVED_SHARE)} * rippleVariance;
  float each = {number((1 - ripples.UNRESOLVED_SHARE) / ripples.OCTAVE_COUNT)} * rippleVariance;
  float steep = sqrt(each / {number(ripples.GRADIENT_VARIANCE)});
  vec2 slope = vec2(0.0);
  lost += {number(ripples.OCTAVE_COUNT)} * each;
  float drawn = log(2.0 * footprint / wave) / {number(np.log(ripples.OCTAVE_RATIO))};
  int octaves = rippleVariance > 0.0 ? int(clamp(ceil(drawn), 0.0, {number(ripples.OCTAVE_COUNT)})) : 0;
  for (int o = 0; o < octaves; o++) {{
    float fade = clamp((wave / footprint - 2.0) / 4.0, 0.0, 1.0);
    vec2 q = vec2((p.x * c + p.y * s) / wave - time * {number(ripples.PHASE_SPEED)} / sqrt(wave),
                  {number(ripples.CREST_STRETCH)} * (p.y * c - p.x * s) / wave) +
             {number(ripples.OCTAVE_SHIFT)} * float(o);
    vec2 t = vec2({number(ripples.NOISE_TURN[0])} * q.x - {number(ripples.NOISE_TURN[1])} * q.y,
                  {number(ripples.NOISE_TURN[1])} * q.x + {number(ripples.NOISE_TURN[0])} * q.y);
    vec2 a = noise(q).yz, b = noise({number(ripples.NOISE_STRETCH)} * t + {number(ripples.NOISE_SHIFT)}).yz;
    float down = a.x + 0.8 * ({number(ripples.NOISE_TURN[0])} * b.x + {number(ripples.NOISE_TURN[1])} * b.y);
    float side = {number(ripples.CREST_STRETCH)} *
                 (a.y + 0.8 * ({number(ripples.NOISE_TURN[0])} * b.y - {number(ripples.NOISE_TURN[1])} * b.x));
    slope += fade * steep * vec2(down * c - side * s, down * s + side * c);
    lost -= fade * fade * each;
    wave *= {number(ripples.OCTAVE_RATIO)};
  }}
  return vec3(slope, 0.5 * lost);
}}
vec3 fromWithin(float height, vec3 n, vec3 e, float ct, float bubbles, float sunlit) {{
  float up = 2.2 * skyLight.y, thin = clamp(0.25 + 0.5 * height, 0.0, 1.0);
  float behind = max(-dot(e, vec3(sunDir.x, 0.0, sunDir.z)), 0.0), tilt = 3.0 * clamp(1.0 - n.y * n.y, 0.0, 0.3);
  float through = 0.25 * up + 1.9 * sunLight.y * (0.30 + 1.3 * behind * behind) * thin * (0.25 + tilt);
  float sunny = 0.25 * up + (through - 0.25 * up) * sunlit;
  vec3 milky = bubbles * {vector(w.BUBBLE_LIGHT)} * (up + sunLight.y * sunlit);
  return 2.0 * up * {vector(w.BODY_LIGHT)} + {vector(w.THIN_LIGHT)} * sunny * (0.55 + 0.45 * ct) + milky;
}}
vec3 foamColour(vec3 n, float white, vec3 heap, float sunlit) {{
  float up = max(n.y, 0.1);
  n = normalize(vec3(n.x / up - white * heap.x, 1.0, n.z / up - white * heap.y));
  float sunny = max(0.7 * dot(n, sunDir) + 0.3 * sunDir.y + 0.06, 0.0), bright = 1.0 + white * (heap.z - 1.0);
  vec3 light = 1.25 * skyLight + 1.75 * sunLight * sunny * sunlit;
  return bright * mix({vector(w.THIN_FOAM_REFLECTANCE)}, {vector(w.FOAM_REFLECTANCE)}, white) * light;
}}
vec3 sunGlint(vec3 n, vec3 e, float variance) {{
  vec3 h = normalize(sunDir + e);
  float c2 = max(dot(h, n), 0.001);
  c2 *= c2;
  float facets = exp(-(1.0 - c2) / (c2 * 2.0 * variance)) / (6.283185307 * variance * c2 * c2);
  float share = fresnel(clamp(dot(h, e), 0.0, 1.0));
  return {number(w.SUN_STRENGTH)} * sunLight * share * facets / (4.0 * max(dot(n, e), 0.12));
}}
"""


def water_program(ships: int, grain: str = "posW.xz", shadows: str = "") -> str:
    """GLSL program of the water around some ships, whose maps of distances to the hulls are stacked in one texture.
    `grain`: expression of the place at which foam's grain is read; `shadows`: program that reduces `sunlit`."""
    hulls = "".join(hull_program(k, ships) for k in range(ships))
    mirrors = "".join(mirror_program(k) for k in range(ships))
    return f"""
  vec3 away = posW - eyeW;
  float dist = length(away);
  away /= dist;
  vec3 e = -away, n = normalize(nrmW);
  float share = attW.x, variance = attW.z, sunlit = 1.0;
{hulls}{shadows}  share = useFoam * clamp(share, 0.0, 1.0);
  float slant = sqrt(max(dot(e, n), {number(ripples.MIN_VIEW_COSINE)}));
  float footprint = max(pixel * dist / slant, 0.004);
  if (rippleVariance > 0.0) {{
    vec3 r = ripples(posW.xz, footprint * inversesqrt(slant));
    float up = max(n.y, 0.1);
    n = normalize(vec3(n.x / up - r.x, 1.0, n.z / up - r.y));
    variance += r.z;
  }}
  variance = clamp(variance, {number(ripples.MIN_SLOPE_VARIANCE)}, {number(ripples.MAX_SLOPE_VARIANCE)});
  float back = 0.03 - dot(n, e);
  if (back > 0.01) n = normalize(n + e * back);
  float ci = max(dot(n, e), 0.02), blur = sqrt(variance);
  float reflectance = useFresnel > 0.5 ? fresnel(min(sqrt(ci * ci + 0.55 * variance), 1.0)) : constantShare;
  vec3 ray = 2.0 * dot(n, e) * n - e;
  if (ray.y < 0.0) ray.y = 0.01 - 0.6 * ray.y;
  vec3 straight = normalize(ray);
  ray.y += 0.35 * blur * (1.0 - ci);
  float blurred = min({number(w.BLUR_LEVELS)} * blur, {number(w.MAX_BLUR_LEVEL)});
  vec3 mirrored = min(skyAt(normalize(ray), blurred), vec3({number(w.MAX_MIRRORED)}));
  float hidden = 0.0;
{mirrors}  if (glintKind > 1.5) mirrored *= 1.0 + {number(w.HDR_FACTOR)} *
    clamp(mirrored.r - {number(w.HDR_THRESHOLD)}, 0.0, {number(w.HDR_EXCESS)});
  vec3 c = useReflection * reflectance * mirrored;
  c += useBody * (1.0 - reflectance) * fromWithin(attW.y, n, e, refracted(ci), share, sunlit);
  if (glintKind > 0.5 && glintKind < 1.5) c += sunGlint(n, e, variance) * (1.0 - hidden) * sunlit;
  float foamy = white(share, {grain}, footprint);
  int lies = foamy > 0.0 ? 1 : 0;
  for (int turn = 0; turn < lies; turn++) c = mix(c, foamColour(n, foamy, heaps({grain}, footprint), sunlit), foamy);
  fragOutput0 = vec4(filmic(foggy(c, away, dist)), 1.0);
"""


def hull_program(k: int, ships: int) -> str:
    """GLSL program of the foam along the waterline of ship k of `ships`; it discards water inside the hull."""
    return f"""
  vec2 uv{k} = (posW.xz - hullBox{k}.xy) / hullSize{k}.xy;
  int near{k} = useHull{k} > 0.5 && all(greaterThan(uv{k}, vec2(0.0))) && all(lessThan(uv{k}, vec2(1.0))) ? 1 : 0;
  for (int turn = 0; turn < near{k}; turn++) {{
    vec2 near = textureLod(hull, vec2(uv{k}.x, ({k}.0 + uv{k}.y) / {ships}.0), 0.0).rg;
    if (near.r < -0.12) discard;
    share = max(share, max(hullFoam.x * exp(-max(near.r, 0.0) / hullFoam.y), near.g));
  }}
"""


def mirror_program(k: int) -> str:
    """GLSL program of the mirror image of ship k in the water, no farther from her middle than mirrorReach."""
    return f"""
  float reach{k} = dot(mirrorAt{k}.xz - posW.xz, normalize(straight.xz));
  vec3 met{k} = posW + straight * max(reach{k}, 1.0);
  bool there{k} = useMirror > 0.5 && reach{k} > -mirrorSize{k} && distance(met{k}.xz, mirrorAt{k}.xz) < mirrorReach{k};
  int mirrors{k} = there{k} ? 1 : 0;
  for (int turn = 0; turn < mirrors{k}; turn++) {{
    float reach = reach{k};
    vec4 seen = mirrorView * vec4(met{k}, 1.0);
    vec2 uv = 0.5 + 0.5 * seen.xy / seen.w;
    if (seen.w > 0.0 && all(greaterThan(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0)))) {{
      vec4 ship = textureLod(mirror, uv, clamp(log2(7.0 * blur * max(reach, 1.0) / (dist * mirrorPixel)), 0.0, 6.0));
      float covered = ship.a * smoothstep(-mirrorSize{k}, 0.0, reach);
      if (covered > 0.0) mirrored = mix(mirrored, radiance(min(ship.rgb / max(ship.a, 0.01), vec3(1.0))), covered);
      hidden = max(hidden, covered);
    }}
  }}
"""


BEYOND_PROGRAM = """
  if (all(greaterThan(posW.xz, innerLow.xz)) && all(lessThan(posW.xz, innerHigh.xz))) discard;
"""  # of the far sea: the basin is drawn by its own surface

SKY_PROGRAM = "  fragOutput0 = vec4(filmic(skyAt(normalize(posW - eyeW), 0.0)), 1.0);\n"


def sky_textures(sky: Sky) -> dict[str, Any]:
    """Textures of a sky's image and of its haze, by their sampler names in the shaders."""
    return {"sky": make_texture(sky.image, smaller=True), "haze": make_texture(sky.haze)}


def make_texture(image: np.ndarray, *, smaller: bool = False) -> Any:
    """Texture of an image of floats or 8-bit numbers, its row 0 at the coordinate 0; `smaller`: True for mipmaps."""
    from vtkmodules.vtkCommonDataModel import vtkImageData

    data = vtkImageData()
    fill_image(data, image)
    return image_texture(data, smaller)


def image_texture(data: Any, smaller: bool) -> Any:
    """Texture of a VTK image; `smaller`: True for mipmaps. Each window needs a texture of its own: a shared one would
    be sent to each window again in every picture."""
    from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLTexture

    made = vtkOpenGLTexture()
    made.SetMipmap(smaller)
    made.InterpolateOn()
    made.SetMaximumAnisotropicFiltering(1)  # else levels asked for are not those read, where neighbours look elsewhere
    made.RepeatOff()
    made.EdgeClampOn()
    made.SetColorModeToDirectScalars()
    made.SetInputDataObject(data)
    return made


def own_textures(textures: dict[str, Any]) -> dict[str, Any]:
    """Textures of the same images, by the same names, for another window."""
    return {name: image_texture(of.GetInput(), of.GetMipmap()) for name, of in textures.items()}


def fill_image(data: Any, image: np.ndarray) -> None:
    """Copy pixels (height, width, channels) into a VTK image."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    height, width, channels = image.shape
    data.SetDimensions(width, height, 1)
    data.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(image.reshape(-1, channels)), deep=True))
    data.Modified()


class Shaded:
    """Actor of triangles with its own fragment program; its points are world coordinates [m]."""

    def __init__(
        self, mesh: Any, body: str, functions: str, textures: dict[str, Any], attributes: Sequence[str] = ()
    ) -> None:
        """`body`, `functions`: fragment program and its GLSL functions; `textures`: by sampler name; `attributes`:
        three-letter names of the mesh's vectors, which the program reads with a W appended, as nrmW."""
        self.mesh, self.attributes, self.textures = mesh, attributes, textures
        self.actor = self.drawn(textures)
        program = self.actor.GetShaderProperty()
        taken = "".join(f"in vec3 {name}In; out vec3 {name}W;\n" for name in attributes)
        given = "".join(f"in vec3 {name}W;\n" for name in attributes)
        copied = "".join(f"  {name}W = {name}In;\n" for name in attributes)
        keep = "//VTK::Normal::Dec\n"
        program.AddVertexShaderReplacement("//VTK::Normal::Dec", True, f"{keep}{taken}out vec3 posW;\n", False)
        body_of_vertex = f"//VTK::Normal::Impl\n{copied}  posW = vertexMC.xyz;\n"
        program.AddVertexShaderReplacement("//VTK::Normal::Impl", True, body_of_vertex, False)
        program.AddFragmentShaderReplacement("//VTK::Normal::Dec", True, f"{keep}{given}in vec3 posW;\n", False)
        declared = f"//VTK::TMap::Dec\n{COMMON_FUNCTIONS}{functions}"
        program.AddFragmentShaderReplacement("//VTK::TMap::Dec", True, declared, False)
        program.AddFragmentShaderReplacement("//VTK::Light::Impl", True, body, False)
        self.uniforms = program.GetFragmentCustomUniforms()

    def drawn(self, textures: dict[str, Any]) -> Any:
        """New actor of the mesh and its attributes with these textures, and without the program."""
        from vtkmodules.vtkCommonDataModel import vtkDataObject
        from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

        mapper, actor = vtkPolyDataMapper(), vtkActor()
        mapper.SetInputData(self.mesh)
        mapper.ScalarVisibilityOff()
        mapper.SetVBOShiftScaleMethod(0)  # positions reach the shader as they are
        for name in self.attributes:
            mapper.MapDataArrayToVertexAttribute(f"{name}In", name, vtkDataObject.FIELD_ASSOCIATION_POINTS, -1)
        actor.SetMapper(mapper)
        for name, image in textures.items():
            actor.GetProperty().SetTexture(name, image)
        return actor

    def twin(self) -> Any:
        """Second actor of the same mesh and program for another plotter, with textures of its own."""
        twin = self.drawn(own_textures(self.textures))
        twin.SetShaderProperty(self.actor.GetShaderProperty())
        return twin

    def set(self, **values: Any) -> None:
        """Set uniforms of the fragment program: numbers, triples and 4 x 4 matrices."""
        from vtkmodules.vtkCommonMath import vtkMatrix4x4

        for name, value in values.items():
            array = np.asarray(value, dtype=float)
            if array.shape == (4, 4):
                matrix = vtkMatrix4x4()
                matrix.DeepCopy(array.T.ravel().tolist())
                self.uniforms.SetUniformMatrix(name, matrix)
            elif array.ndim:
                self.uniforms.SetUniform3f(name, array.tolist())
            else:
                self.uniforms.SetUniformf(name, float(array))


def projection(camera: Any, aspect: float) -> np.ndarray:
    """Projection (4, 4) of a VTK camera from world to clip coordinates, in a picture of an `aspect` ratio."""
    matrix = camera.GetCompositeProjectionTransformMatrix(aspect, -1.0, 1.0)
    return np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])


def collect_messages() -> Any:
    """Redirect VTK's messages to a collector from now on; returns the collector, to pass to `refusal`."""
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

    said = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(said)
    return said


def refusal(said: Any) -> str | None:
    """Reason why OpenGL refused a shader program, from messages of `collect_messages`; None if it refused none."""
    if "vtkShaderProgram" not in (text := said.GetOutput()):
        return None
    why = (line for line in text.splitlines() if "error" in line.lower() and not line.startswith("ERROR: In"))
    return next(why, "it does not say why").rsplit("): ", 1)[-1]


def sky_uniforms(sky: Sky) -> dict[str, Any]:
    """Uniforms of the sun and of the mean light of a sky."""
    return {"sunDir": sky.sun, "sunLight": sky.sunlight, "skyLight": sky.ambient}


def neutral_uniforms(ships: int) -> dict[str, Any]:
    """Uniforms of calm, smooth water without mirrored ships and with all terms of its colour, except those of light."""
    nothing = dict.fromkeys(("useMirror", "rippleVariance", "windAngle", "time"), 0.0)
    ones = dict.fromkeys(("rippleLongest", "mirrorPixel", "glintKind"), 1.0)  # the kind of glint is a key of GLINTS
    ones |= dict.fromkeys(("useFresnel", "useReflection", "useBody", "useFoam", "useFog"), 1.0)
    known = {"exposure": w.SEA_EXPOSURE, "fogReach": w.FOG_DISTANCE, "mirrorView": np.eye(4), "hullFoam": np.ones(3)}
    known["constantShare"] = CONSTANT_REFLECTANCE
    for k in range(ships):
        nothing |= {f"useHull{k}": 0.0}
        ones |= {f"mirrorSize{k}": 1.0, f"mirrorReach{k}": 1.0}
        known |= {f"hullBox{k}": np.zeros(3), f"hullSize{k}": np.ones(3), f"mirrorAt{k}": np.zeros(3)}
    return known | nothing | ones
