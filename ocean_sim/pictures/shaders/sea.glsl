// Water around some ships, whose maps of distances to the hulls are stacked in one texture. hulls, mirrors: programs of
// each ship; shadows: program that reduces `sunlit`; grain: place at which foam's grain is read.
  vec3 away = posW - eyeW;
  float dist = length(away);
  away /= dist;
  vec3 e = -away, n = normalize(nrmW);
  float share = attW.x, variance = attW.z, sunlit = 1.0;
@hulls@shadows
  share = useFoam * clamp(share, 0.0, 1.0);
  float slant = sqrt(max(dot(e, n), MIN_VIEW_COSINE));
  float footprint = max(pixel * dist / slant, 0.004);
  if (rippleVariance > 0.0) {
    vec3 r = ripples(posW.xz, footprint * inversesqrt(slant));
    float up = max(n.y, 0.1);
    n = normalize(vec3(n.x / up - r.x, 1.0, n.z / up - r.y));
    variance += r.z;
  }
  variance = clamp(variance, MIN_SLOPE_VARIANCE, MAX_SLOPE_VARIANCE);
  float back = 0.03 - dot(n, e);
  if (back > 0.01) n = normalize(n + e * back);
  float ci = max(dot(n, e), 0.02), blur = sqrt(variance);
  float reflectance = useFresnel > 0.5 ? fresnel(min(sqrt(ci * ci + 0.55 * variance), 1.0)) : constantShare;
  vec3 ray = 2.0 * dot(n, e) * n - e;
  if (ray.y < 0.0) ray.y = 0.01 - 0.6 * ray.y;
  vec3 straight = normalize(ray);
  ray.y += 0.35 * blur * (1.0 - ci);
  float blurred = min(BLUR_LEVELS * blur, MAX_BLUR_LEVEL);
  vec3 mirrored = min(skyAt(normalize(ray), blurred), vec3(MAX_MIRRORED));
  float hidden = 0.0;
@mirrors
  if (glintKind > 1.5) mirrored *= 1.0 + HDR_FACTOR *
    clamp(mirrored.r - HDR_THRESHOLD, 0.0, HDR_EXCESS);
  vec3 c = useReflection * reflectance * mirrored;
  c += useBody * (1.0 - reflectance) * fromWithin(attW.y, n, e, refracted(ci), share, sunlit);
  if (glintKind > 0.5 && glintKind < 1.5) c += sunGlint(n, e, variance) * (1.0 - hidden) * sunlit;
  float foamy = white(share, @grain, footprint);
  int lies = foamy > 0.0 ? 1 : 0;
  for (int turn = 0; turn < lies; turn++) c = mix(c, foamColour(n, foamy, heaps(@grain, footprint), sunlit), foamy);
  fragOutput0 = vec4(filmic(foggy(c, away, dist)), 1.0);
