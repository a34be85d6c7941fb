// The haze is fetched from a fine row around the horizon, in less time than it is found in the sky.
vec3 foggy(vec3 c, vec3 away, float dist) {
  float f = 1.0 - exp(-dist / fogReach);
  f *= 0.5 + 0.5 * f * (3.0 - 2.0 * f);
  f = mix(f, 1.0, smoothstep(FOG_END[0], FOG_END[1], dist / fogReach));
  float ahead = away.x / max(abs(away.x) + abs(away.z), 1e-6);
  float at = away.z < 0.0 ? 3.0 + ahead : 1.0 - ahead;
  int k = int(float(HAZE_SIZE[0] * HAZE_SIZE[1] / 4) * at) % (HAZE_SIZE[0] * HAZE_SIZE[1]);
  return mix(c, texelFetch(haze, ivec2(k % HAZE_SIZE[1], k / HAZE_SIZE[1]), 0).rgb, f * useFog);
}
