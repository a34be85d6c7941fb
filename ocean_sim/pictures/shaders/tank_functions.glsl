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
