vec3 skyAt(vec3 d, float level) {
  d = normalize(vec3(d.x, max(d.y, MIN_SKY_HEIGHT), d.z));
  return textureLod(sky, 0.5 + 0.5 * d.xz / (1.0 + d.y), level).rgb;
}
vec3 filmic(vec3 c) {
  c = max(c, vec3(0.0)) * exposure;
  c = c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14);
  vec3 s = sqrt(clamp(c, 0.0, 1.0));
  return s * (GAMMA_POLYNOMIAL[0] + s * (GAMMA_POLYNOMIAL[1] + GAMMA_POLYNOMIAL[2] * s)) /
         (GAMMA_POLYNOMIAL[3] + s * (GAMMA_POLYNOMIAL[4] + s));
}
vec3 radiance(vec3 shown) {
  vec3 y = min(pow(shown, vec3(2.2)), vec3(0.98));
  vec3 a = 2.51 - 2.43 * y, b = 0.03 - 0.59 * y;
  return (sqrt(b * b + 0.56 * a * y) - b) / (2.0 * a * exposure);
}
