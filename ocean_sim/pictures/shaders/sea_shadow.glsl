// Shadow of ship @k on the water; the shadow maps of all ships are stacked in one texture.
  vec3 off@k = posW - shadeAt@k;
  vec2 cast@k = 0.5 + 0.5 * vec2(dot(off@k, sunRight), dot(off@k, sunUp)) / shadeSize@k;
  bool inside@k = all(greaterThan(cast@k, shadeLow@k.xy)) && all(lessThan(cast@k, shadeHigh@k.xy));
  int dark@k = inside@k && dot(off@k, sunDir) < shadeHigh@k.z ? 1 : 0;
  float depth@k = dot(off@k, sunDir) + SHADOW_BIAS * shadeSize@k;
  for (int turn = 0; turn < dark@k; turn++)
    sunlit -= 1.0 - open(float(SHADOW_PIXELS) * cast@k, depth@k, @k * SHADOW_PIXELS);
