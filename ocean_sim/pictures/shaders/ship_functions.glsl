float sunlit(vec3 p, vec3 n) {
  vec3 q = p + SHADOW_BIAS * shipLength * n - shipAt;
  vec2 at = float(SHADOW_PIXELS) * (0.5 + 0.5 * vec2(dot(q, sunRight), dot(q, sunUp)) / shipLength);
  return open(at, dot(q, sunDir) + (2.5 - 1.5 * dot(n, sunDir)) * SHADOW_BIAS * shipLength, 0);
}
