"""Water in a tank as clear as it is: what lies behind it is seen bent and dimmed by the way that light goes through it.

Pictures come before: of everything but the water, and of how far away its back faces are. The shader takes the
difference of both faces as the thickness, absorbs and scatters along it (Beer and Lambert), and mirrors the sky. What
water hides of other water, as a jet of the pool below it, is drawn first, behind the back faces of the nearer one.
"""

import numpy as np

from ocean_sim.pictures import sky
from ocean_sim.pictures import water_shading as w
from ocean_sim.pictures.water_glsl import number, vector

ABSORBED = np.array([3.0, 0.85, 0.60])  # of light, in a way as long as the tank is deep
SCATTERED = np.array([0.016, 0.135, 0.170])  # light that comes back from water so thick that nothing shines through
SHINE = 0.004  # variance of slopes that widen the sun's highlight
RELIEF = 1.6  # by which slopes are steeper than they are in the light of a map
GRAIN = 0.5  # of foam: how many of its metres on a sea a spacing of the particles is in a tank
WRINKLES, STEEP = (0.55, 1.5), (0.40, 0.30)  # [1/spacing] of two scales, and how far each tilts a skin that is stirred
SKEWED = (0.7, 0.4)  # of the height at which water was born, in the two coordinates of its grain
HOLES = 1.15  # share of a skin that is gone where it is wholly torn, over 1
FOAM, SHADE = (
    np.array([0.80, 0.83, 0.84]),
    (0.62, 0.38),
)  # of water full of bubbles; its light from all sides, and the sun's

SEEN = """
vec3 from(vec3 p) { return mix(p - eyeW, ahead * dot(p - eyeW, ahead), parallel); }
float measured(vec4 met) { return (met.r * 255.0 + met.g) / 255.0; }
bool isBehind(float dist, ivec2 here) {
  vec4 nearer = texelFetch(before, here, 0);
  return behindOthers < 0.5 || dist / reach > (nearer.a > 0.5 ? measured(nearer) + 0.0005 : 2.0);
}
"""  # the way from the eye, in parallel projection from its plane; and which water other water hides

DISTANCE = """
  float dist = length(from(posW));
  if (!isBehind(dist, ivec2(gl_FragCoord.xy))) discard;
  float far = clamp(dist / reach, 0.0, 1.0) * 255.0;
  fragOutput0 = vec4(floor(far) / 255.0, fract(far), 0.0, 1.0);
"""

GRAINS = f"""
vec2 grainAt(vec3 was) {{
  vec3 q = was / spacing;
  return vec2(q.x + {number(SKEWED[0])} * q.y, q.z - {number(SKEWED[1])} * q.y);
}}
vec3 wrinkled(vec3 n, vec2 q, float footprint, float rough) {{
  const vec2 scales = vec2({number(WRINKLES[0])}, {number(WRINKLES[1])});
  const vec2 steep = vec2({number(STEEP[0])}, {number(STEEP[1])});
  vec3 tilt = vec3(0.0);
  for (int o = 0; o < 2; o++) {{
    float fine = clamp(1.5 - 3.0 * footprint * scales[o], 0.0, 1.0);
    vec2 p = scales[o] * q;
    tilt += fine * steep[o] * (vec3(noise(p + 11.0).x, noise(p + 37.0).x, noise(p + 71.0).x) - 0.5);
  }}
  return normalize(n + rough * tilt);
}}
"""

WATER = f"""
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
  if (torn > 0.02 && noise(0.8 * q + 3.0).x * 0.6 + noise(2.1 * q).x * 0.4 < {number(HOLES)} * torn - 0.15) discard;
  if (rough > 0.01) {{
    n = wrinkled(n, q, footprint, rough);
    float turned = 0.03 - dot(n, e);
    if (turned > 0.0) n = normalize(n + e * turned);
  }}
  vec4 exit = texelFetch(back, here, 0);
  float thick = exit.a > 0.5 ? max(measured(exit) * reach - dist, 0.0) : 0.0;
  vec3 down = refract(away, n, {number(1.0 / w.REFRACTIVE_INDEX)});
  vec3 onwards = step(vec3(0.0), down);
  vec3 ends = (mix(boxLow, boxHigh, onwards) - posW) / (down + mix(vec3(-1e-6), vec3(1e-6), onwards));
  thick = min(thick, max(min(ends.x, min(ends.y, ends.z)), 0.0));
  vec4 at = view * vec4(posW + thick * down, 1.0);
  vec3 behind = radiance(min(textureLod(scene, clamp(0.5 + 0.5 * at.xy / at.w, 0.002, 0.998), 0.0).rgb, vec3(1.0)));
  thick /= depth;
  vec3 left = exp(-{vector(ABSORBED)} * thick);
  float share = fresnel(clamp(dot(n, e), 0.02, 1.0));
  float lit = 0.55 + 0.45 * clamp(dot(n, sunDir), -0.4, 1.0);
  vec3 ray = reflect(away, n);
  vec3 over = ray.y > 0.0 ? min(skyAt(ray, 2.0), vec3(1.4)) : 0.45 * {vector(sky.HORIZON)};
  vec3 c = (behind * left + {vector(SCATTERED)} * lit * (1.0 - left)) * (1.0 - share) + over * share;
  vec3 h = normalize(sunDir + e);
  float c2 = max(dot(h, n), 0.001);
  c2 *= c2;
  c += {vector(sky.SUNLIGHT)} * min(0.5 * share * exp(-(1.0 - c2) / (c2 * {number(2.0 * SHINE)})) /
    ({number(2.0 * np.pi * SHINE)} * c2 * c2), 2.5);
  float foamy = white(airy, {number(GRAIN)} * q, {number(GRAIN)} * footprint);
  if (foamy > 0.0) {{
    vec3 heap = heaps({number(GRAIN)} * q, {number(GRAIN)} * footprint);
    float bright = {number(SHADE[0])} + {number(SHADE[1])} * max(dot(n, sunDir) + 0.2 * (heap.x + heap.y), 0.0);
    c = mix(c, {vector(FOAM)} * bright * (1.0 + foamy * (heap.z - 1.0)), foamy);
  }}
  vec2 slope = {number(RELIEF)} * n.xz / max(n.y, 0.05);
  slope /= sqrt(1.0 + dot(slope, slope) / {number(w.MAP_STEEPEST**2)});
  float hill = max(dot(normalize(vec3(slope.x, 1.0, slope.y)), {vector(w.MAP_LIGHT)}), 0.0);
  fragOutput0 = vec4(filmic(c * mix(1.0, 0.3 + 1.12 * hill, onMap)), 1.0);
"""
