  float dist = length(from(posW));
  if (!isBehind(dist, ivec2(gl_FragCoord.xy))) discard;
  float far = clamp(dist / reach, 0.0, 1.0) * 255.0;
  fragOutput0 = vec4(floor(far) / 255.0, fract(far), 0.0, 1.0);
