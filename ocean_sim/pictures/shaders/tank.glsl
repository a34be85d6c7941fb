  vec3 away = from(posW);
  float dist = length(away);
  away /= dist;
  ivec2 here = ivec2(gl_FragCoord.xy * vec2(textureSize(back, 0)) / screen.xy);
  if (!isBehind(dist, here)) discard;
  vec3 e = -away, n = normalize(nrmW);
  if (dot(n, e) < 0.0) n = -n;
  vec2 q = grainAt(wasW);
  float footprint = pixel * mix(dist, 1.0, parallel) / spacing;
  float airy = clamp(airW.x, 0.0, 1.0);
  vec4 exit = texelFetch(back, here, 0);
  float thick = exit.a > 0.5 ? max(measured(exit) * reach - dist, 0.0) : 0.0;
  vec3 down = refract(away, n, 1.0 / REFRACTIVE_INDEX);
  vec3 onwards = step(vec3(0.0), down);
  vec3 ends = (mix(boxLow, boxHigh, onwards) - posW) / (down + mix(vec3(-1e-6), vec3(1e-6), onwards));
  thick = min(thick, max(min(ends.x, min(ends.y, ends.z)), 0.0));
  vec4 at = view * vec4(posW + thick * down, 1.0);
  vec2 bent = clamp(0.5 + 0.5 * at.xy / at.w, 0.002, 0.998);
  ivec2 last = textureSize(scene, 0) - 4, corner = clamp(ivec2(bent * vec2(last + 4) - 1.5), ivec2(0), last);
  float near = 1.0;
  for (int k = 0; k < 16; k++) near = min(near, texelFetch(scene, corner + ivec2(k % 4, k / 4), 0).a);
  if (near < dot(posW - eyeW, ahead) / reach - 0.01) bent = gl_FragCoord.xy / screen.xy;  // it stands before the water
  vec3 behind = radiance(min(textureLod(scene, bent, 0.0).rgb, vec3(1.0)));
  thick /= depth;
  vec3 left = exp(-ABSORPTION * thick);
  float share = fresnel(clamp(dot(n, e), 0.02, 1.0));
  float lit = 0.55 + 0.45 * clamp(dot(n, sunDir), -0.4, 1.0);
  vec3 ray = reflect(away, n);
  vec3 over = ray.y > 0.0 ? min(skyAt(ray, 2.0), vec3(1.4)) : 0.45 * HORIZON_COLOUR;
  vec3 c = (behind * left + SCATTERED_LIGHT * lit * (1.0 - left)) * (1.0 - share) + over * share;
  vec3 h = normalize(sunDir + e);
  float c2 = max(dot(h, n), 0.001);
  c2 *= c2;
  c += SUNLIGHT_COLOUR * min(0.5 * share * exp(-(1.0 - c2) / (c2 * 2.0 * SHINE_VARIANCE)) /
    (6.283185307 * SHINE_VARIANCE * c2 * c2), 2.5);
  float foamy = white(airy, GRAIN_LENGTH * q, GRAIN_LENGTH * footprint);
  if (foamy > 0.0) {
    vec3 heap = heaps(GRAIN_LENGTH * q, GRAIN_LENGTH * footprint);
    float bright = FOAM_LIGHTS[0] +
      FOAM_LIGHTS[1] * max(dot(n, sunDir) + 0.2 * (heap.x + heap.y), 0.0);
    c = mix(c, FOAM_COLOUR * bright * (1.0 + foamy * (heap.z - 1.0)), foamy);
  }
  vec2 slope = RELIEF_FACTOR * n.xz / max(n.y, 0.05);
  slope /= sqrt(1.0 + dot(slope, slope) / (MAP_STEEPEST * MAP_STEEPEST));
  float hill = max(dot(normalize(vec3(slope.x, 1.0, slope.y)), MAP_LIGHT), 0.0);
  fragOutput0 = vec4(filmic(c * mix(1.0, 0.3 + 1.12 * hill, onMap)), 1.0);
