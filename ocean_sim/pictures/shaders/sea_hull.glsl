// Foam along the waterline of ship @k of @ships; water inside the hull is discarded.
  vec2 uv@k = (posW.xz - hullBox@k.xy) / hullSize@k.xy;
  int near@k = useHull@k > 0.5 && all(greaterThan(uv@k, vec2(0.0))) && all(lessThan(uv@k, vec2(1.0))) ? 1 : 0;
  for (int turn = 0; turn < near@k; turn++) {
    vec2 near = textureLod(hull, vec2(uv@k.x, (float(@k) + uv@k.y) / float(@ships)), 0.0).rg;
    if (near.r < -0.12) discard;
    share = max(share, max(hullFoam.x * exp(-max(near.r, 0.0) / hullFoam.y), near.g));
  }
