//VTK::Color::Impl
  float away = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);
  if (away > 1.0) discard;
  float bright = RIM_LIGHT + (1.0 - RIM_LIGHT) * sqrt(1.0 - away);
  diffuseColor *= bright;
