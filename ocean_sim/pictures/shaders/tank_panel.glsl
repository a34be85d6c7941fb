  vec3 n = normalize(nrmW), across = 1.0 - abs(n);
  float bright = AMBIENT_LIGHT + SUN_LIGHT * max(dot(n, SUN_DIRECTION), 0.0);
  // Another panel, across an axis along this one, takes light next to it; there is none above.
  float nook = NOOK_REACH * (boxHigh.y - boxLow.y);
  vec3 low = 1.0 - NOOK_SHADE * across * exp((boxLow - posW) / nook);
  vec3 high = 1.0 - NOOK_SHADE * across * exp((posW - boxHigh) / nook);
  bright *= low.x * low.y * low.z * high.x * high.z;
  vec3 away = abs(posW - apart * round(posW / apart)), pixel = max(fwidth(posW), 1e-6);
  vec3 line = across * clamp((0.5 * LINE_BREADTH * apart - away) / pixel + 0.5, 0.0, 1.0);
  bright *= mix(1.0, LINE_LIGHT, max(line.x, max(line.y, line.z)));
  fragOutput0 = vec4(bright * PANEL_COLOUR, 1.0);
