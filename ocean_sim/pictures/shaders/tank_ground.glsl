  // The block's soft shadow, and lines that fade away around it.
  vec2 seen = posW.xz + 0.5 * (boxHigh.y - boxLow.y) * SUN_DIRECTION.xz, broad = boxHigh.xz - boxLow.xz;
  vec2 beyond = max(max(boxLow.xz - seen, seen - boxHigh.xz), 0.0) / (SHADOW_SOFTNESS * max(broad.x, broad.y));
  vec2 aside = max(max(boxLow.xz - posW.xz, posW.xz - boxHigh.xz), 0.0) / (GROUND_REACH * max(broad.x, broad.y));
  vec2 away = abs(posW.xz - apart * round(posW.xz / apart)), pixel = max(fwidth(posW.xz), vec2(1e-6));
  vec2 line = clamp((0.5 * LINE_BREADTH * apart - away) / pixel + 0.5, 0.0, 1.0);
  float left = max(1.0 - length(aside), 0.0), drawn = GROUND_LINE_OPACITY * left * left * max(line.x, line.y);
  fragOutput0 = vec4(GROUND_LINE_COLOUR, 1.0 - (1.0 - SHADOW_DARKNESS * exp(-dot(beyond, beyond))) * (1.0 - drawn));
