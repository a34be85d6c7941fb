// Mirror image of ship @k in the water, no farther from her middle than mirrorReach.
  float reach@k = dot(mirrorAt@k.xz - posW.xz, normalize(straight.xz));
  vec3 met@k = posW + straight * max(reach@k, 0.4 * mirrorSize@k);
  bool there@k = useMirror > 0.5 && reach@k > -mirrorSize@k && distance(met@k.xz, mirrorAt@k.xz) < mirrorReach@k;
  int mirrors@k = there@k ? 1 : 0;
  for (int turn = 0; turn < mirrors@k; turn++) {
    float reach = reach@k;
    vec4 seen = mirrorView * vec4(met@k, 1.0);
    vec2 uv = 0.5 + 0.5 * seen.xy / seen.w;
    if (seen.w > 0.0 && all(greaterThan(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0)))) {
      vec4 ship = textureLod(mirror, uv, clamp(log2(7.0 * blur * max(reach, 0.4 * mirrorSize@k) / (dist * mirrorPixel)), 0.0, 6.0));
      float covered = ship.a * smoothstep(-mirrorSize@k, 0.0, reach) *
        smoothstep(mirrorReach@k, 0.7 * mirrorReach@k, distance(met@k.xz, mirrorAt@k.xz));
      if (covered > 0.0) mirrored = mix(mirrored, radiance(min(ship.rgb / max(ship.a, 0.01), vec3(1.0))), covered);
      hidden = max(hidden, covered);
    }
  }
