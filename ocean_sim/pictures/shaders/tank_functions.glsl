// The way from the eye, in parallel projection from its plane; and which water other water hides.
vec3 from(vec3 p) { return mix(p - eyeW, ahead * dot(p - eyeW, ahead), parallel); }
float measured(vec4 met) { return (met.r * 255.0 + met.g) / 255.0; }
bool isBehind(float dist, ivec2 here) {
  vec4 nearer = texelFetch(before, here, 0);
  return behindOthers < 0.5 || dist / reach > (nearer.a > 0.5 ? measured(nearer) + 0.0005 : 2.0);
}
vec2 grainAt(vec3 was) {
  vec3 q = was / spacing;
  return vec2(q.x + HEIGHT_SKEW[0] * q.y, q.z - HEIGHT_SKEW[1] * q.y);
}
vec3 wrinkled(vec3 n, vec2 q, float footprint, float rough) {
  const vec2 scales = WRINKLE_SCALES;
  const vec2 steep = WRINKLE_SLOPES;
  vec3 tilt = vec3(0.0);
  for (int o = 0; o < 2; o++) {
    float fine = clamp(1.5 - 3.0 * footprint * scales[o], 0.0, 1.0);
    vec2 p = scales[o] * q;
    tilt += fine * steep[o] * (vec3(noise(p + 11.0).x, noise(p + 37.0).x, noise(p + 71.0).x) - 0.5);
  }
  return normalize(n + rough * tilt);
}
