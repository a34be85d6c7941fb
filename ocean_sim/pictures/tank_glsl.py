"""Water in a tank as clear as it is: what lies behind it is seen bent and dimmed by the way that light goes through it.

Two pictures come before: of everything but the water, and of how far away its back faces are. The shader takes the
difference of both faces as the thickness, absorbs and scatters along it (Beer and Lambert), and mirrors the sky.
"""

import numpy as np

from ocean_sim.pictures import sky
from ocean_sim.pictures import water_shading as w
from ocean_sim.pictures.water_glsl import number, vector

ABSORBED = np.array([3.6, 1.05, 0.75])  # of light, in a way as long as the tank is deep
SCATTERED = np.array([0.012, 0.125, 0.165])  # light that comes back from water so thick that nothing shines through
SHINE = 0.004  # variance of slopes that widen the sun's highlight
RELIEF = 1.6  # by which slopes are steeper than they are in the light of a map

DISTANCE = """
  float far = clamp(distance(posW, eyeW) / reach, 0.0, 1.0) * 255.0;
  fragOutput0 = vec4(floor(far) / 255.0, fract(far), 0.0, 1.0);
"""

WATER = f"""
  vec3 away = posW - eyeW;
  float dist = length(away);
  away /= dist;
  vec3 e = -away, n = normalize(nrmW);
  if (dot(n, e) < 0.0) n = -n;
  vec4 at = view * vec4(posW, 1.0);
  vec4 exit = texelFetch(back, ivec2((0.5 + 0.5 * at.xy / at.w) * vec2(textureSize(back, 0))), 0);
  float thick = exit.a > 0.5 ? max((exit.r * 255.0 + exit.g) / 255.0 * reach - dist, 0.0) : 0.0;
  vec3 down = refract(away, n, {number(1.0 / w.REFRACTIVE_INDEX)});
  at = view * vec4(posW + min(thick, depth) * down, 1.0);
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
  vec2 slope = {number(RELIEF)} * n.xz / max(n.y, 0.05);
  slope /= sqrt(1.0 + dot(slope, slope) / {number(w.MAP_STEEPEST**2)});
  float hill = max(dot(normalize(vec3(slope.x, 1.0, slope.y)), {vector(w.MAP_LIGHT)}), 0.0);
  fragOutput0 = vec4(filmic(c * mix(1.0, 0.3 + 1.12 * hill, onMap)), 1.0);
"""
