float refracted(float ci) { return sqrt(1.0 - (1.0 - ci * ci) / (REFRACTIVE_INDEX * REFRACTIVE_INDEX)); }
float fresnel(float ci) {
  const float n = REFRACTIVE_INDEX;
  float ct = refracted(ci), rs = (ci - n * ct) / (ci + n * ct), rp = (n * ci - ct) / (n * ci + ct);
  return 0.5 * (rs * rs + rp * rp);
}
float chance(ivec2 p) {
  uint n = uint(p.x) * 374761393u + uint(p.y) * 668265263u;
  n = (n ^ (n >> 13u)) * 1274126177u;
  return float(n >> 16u) * (1.0 / 65535.0);
}
vec3 noise(vec2 p) {
  vec2 w = floor(p), f = p - w;
  ivec2 i = ivec2(w);
  vec2 u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0), du = 30.0 * f * f * (f * (f - 2.0) + 1.0);
  float a = chance(i), b = chance(i + ivec2(1, 0)), c = chance(i + ivec2(0, 1)), d = chance(i + ivec2(1, 1));
  float k = a - b - c + d;
  return vec3(a + (b - a) * u.x + (c - a) * u.y + k * u.x * u.y, du * (vec2(b - a, c - a) + k * u.yx));
}
// Grain of foam at a place, and its variance; octaves that the footprint of a pixel hides are their mean.
vec2 patches(vec2 q, float footprint) {
  q *= GRAIN_SCALE;
  q += GRAIN_BEND * (vec2(noise(0.6 * q + vec2(3.0, 7.0)).x, noise(0.6 * q + vec2(23.0, 11.0)).x) - 0.5);
  float grain = 0.42 * noise(0.45 * q).x, variance = PATCH_VARIANCE, scale = 1.3;
  vec3 shares = vec3(0.30, 0.26, 0.20);
  for (int o = 0; o < 3; o++) {
    q = vec2(OCTAVE_TURN[0] * q.x - OCTAVE_TURN[1] * q.y,
             OCTAVE_TURN[1] * q.x + OCTAVE_TURN[0] * q.y);
    float ridge = 1.0 - abs(2.0 * noise(scale * q + 9.0).x - 1.0);
    float fine = clamp(2.0 - 4.0 * footprint * GRAIN_SCALE * scale, 0.0, 1.0), each = fine * shares[o];
    grain += shares[o] * mix(RIDGE_MEAN, ridge * ridge, fine);
    variance += each * each * RIDGE_VARIANCE;
    scale *= 2.1;
  }
  return vec2(grain, variance);
}
float white(float share, vec2 q, float footprint) {
  float fine = clamp(1.0 - footprint / MAX_FOOTPRINT, 0.0, 1.0);
  float result = share > MIN_SHARE ? share : 0.0;
  int turns = result > 0.0 && fine > 0.0 ? 1 : 0;
  for (int turn = 0; turn < turns; turn++) {
    vec2 grain = patches(q, footprint);
    float rank = 1.0 / (1.0 + exp(1.702 * (grain.x - PATCH_MEAN) * inversesqrt(grain.y)));
    float whiter = (1.0 - MIN_WHITENESS) / WHOLE_SHARE * share;
    float thick = min(MIN_WHITENESS + whiter, 1.0);
    float covered = share / thick, soft = max(min(min(covered, 1.0 - covered), EDGE_SOFTNESS), 0.001);
    float edge = clamp((covered + soft - rank) / (2.0 * soft), 0.0, 1.0);
    result = mix(share, thick * edge * edge * (3.0 - 2.0 * edge), fine);
  }
  return result;
}
vec3 heaps(vec2 q, float footprint) {
  vec2 turned = OCTAVE_TURN, way = turned;
  vec3 scales = HEAP_SCALES, depths = HOLLOW_SHADES, found = vec3(0.0, 0.0, 1.0);
  for (int o = 0; o < 3; o++) {
    float fine = clamp(1.5 - 3.0 * footprint * scales[o], 0.0, 1.0);
    vec3 a = noise(scales[o] * vec2(way.x * q.x - way.y * q.y, way.y * q.x + way.x * q.y) + 5.0);
    found.x += HEAP_SLOPE * fine * (way.x * a.y + way.y * a.z);
    found.y += HEAP_SLOPE * fine * (way.x * a.z - way.y * a.y);
    found.z += depths[o] * fine * (a.x - 0.5);
    way = vec2(way.x * turned.x - way.y * turned.y, way.y * turned.x + way.x * turned.y);
  }
  return found;
}
vec3 ripples(vec2 p, float footprint) {
  float c = cos(windAngle), s = sin(windAngle), wave = rippleLongest;
  float lost = UNRESOLVED_SHARE * rippleVariance;
  float each = (1.0 - UNRESOLVED_SHARE) / float(OCTAVE_COUNT) * rippleVariance;
  float steep = sqrt(each / GRADIENT_VARIANCE);
  vec2 slope = vec2(0.0);
  lost += float(OCTAVE_COUNT) * each;
  float drawn = log(2.0 * footprint / wave) / log(OCTAVE_RATIO);
  int octaves = rippleVariance > 0.0 ? int(clamp(ceil(drawn), 0.0, float(OCTAVE_COUNT))) : 0;
  for (int o = 0; o < octaves; o++) {
    float fade = clamp((wave / footprint - 2.0) / 4.0, 0.0, 1.0);
    vec2 q = vec2((p.x * c + p.y * s) / wave - time * PHASE_SPEED / sqrt(wave),
                  CREST_STRETCH * (p.y * c - p.x * s) / wave) +
             OCTAVE_SHIFT * float(o);
    vec2 t = vec2(NOISE_TURN[0] * q.x - NOISE_TURN[1] * q.y,
                  NOISE_TURN[1] * q.x + NOISE_TURN[0] * q.y);
    vec2 a = noise(q).yz, b = noise(NOISE_STRETCH * t + NOISE_SHIFT).yz;
    float down = a.x + 0.8 * (NOISE_TURN[0] * b.x + NOISE_TURN[1] * b.y);
    float side = CREST_STRETCH *
                 (a.y + 0.8 * (NOISE_TURN[0] * b.y - NOISE_TURN[1] * b.x));
    slope += fade * steep * vec2(down * c - side * s, down * s + side * c);
    lost -= fade * fade * each;
    wave *= OCTAVE_RATIO;
  }
  return vec3(slope, 0.5 * lost);
}
vec3 fromWithin(float height, vec3 n, vec3 e, float ct, float bubbles, float sunlit) {
  float up = 2.2 * skyLight.y, thin = clamp(0.25 + 0.5 * height, 0.0, 1.0);
  float behind = max(-dot(e, vec3(sunDir.x, 0.0, sunDir.z)), 0.0), tilt = 3.0 * clamp(1.0 - n.y * n.y, 0.0, 0.3);
  float through = 0.25 * up + 1.9 * sunLight.y * (0.30 + 1.3 * behind * behind) * thin * (0.25 + tilt);
  float sunny = 0.25 * up + (through - 0.25 * up) * sunlit;
  vec3 milky = bubbles * BUBBLE_LIGHT * (up + sunLight.y * sunlit);
  return 2.0 * up * BODY_LIGHT + THIN_LIGHT * sunny * (0.55 + 0.45 * ct) + milky;
}
vec3 foamColour(vec3 n, float white, vec3 heap, float sunlit) {
  float up = max(n.y, 0.1);
  n = normalize(vec3(n.x / up - white * heap.x, 1.0, n.z / up - white * heap.y));
  float sunny = max(0.7 * dot(n, sunDir) + 0.3 * sunDir.y + 0.06, 0.0), bright = 1.0 + white * (heap.z - 1.0);
  vec3 light = 1.25 * skyLight + 1.75 * sunLight * sunny * sunlit;
  return bright * mix(THIN_FOAM_REFLECTANCE, FOAM_REFLECTANCE, white) * light;
}
vec3 sunGlint(vec3 n, vec3 e, float variance) {
  vec3 h = normalize(sunDir + e);
  float c2 = max(dot(h, n), 0.001);
  c2 *= c2;
  float facets = exp(-(1.0 - c2) / (c2 * 2.0 * variance)) / (6.283185307 * variance * c2 * c2);
  float share = fresnel(clamp(dot(h, e), 0.0, 1.0));
  return SUN_STRENGTH * sunLight * share * facets / (4.0 * max(dot(n, e), 0.12));
}
