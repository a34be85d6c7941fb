  float beyond = max(abs(uvlW.x) - uvlW.z, 0.0), off = beyond * beyond + uvlW.y * uvlW.y;
  if (off > 1.0) discard;
  float share = 1.0 - exp(-opaW.x * (1.0 - off)), size = opaW.z;
  // Each cell of a parcel holds one streak or none; where they are dense, their mean is drawn.
  vec2 q = vec2(uvlW.x / (2.0 * uvlW.z + size), uvlW.y / size) + floor(opaW.y) * vec2(1.0, 1.7), cell = floor(q);
  vec3 h = fract(sin(vec3(dot(cell, vec2(12.99, 78.23)), dot(cell, vec2(39.35, 11.14)), dot(cell, vec2(73.16, 52.24)))) * 437.585);
  float drop = clamp(2.5 - 5.5 * length(q - cell - 0.5 - 0.4 * (h.xy - 0.5)), 0.0, 1.0) * step(h.z, 3.0 * share);
  share = mix(drop, share, max(fract(opaW.y), max(smoothstep(0.2, 0.6, share), smoothstep(0.4, 0.8, size))));
  float c = dot(normalize(posW - eyeW), sunDir), g = FORWARD_SHARE;
  float forward = min((1.0 - g * g) / pow(1.0 + g * g - 2.0 * g * c, 1.5), MAX_FORWARD_LIGHT);
  fragOutput0 = vec4(filmic(1.3 * skyLight + 0.5 * sunLight * (1.0 + forward)), share);
