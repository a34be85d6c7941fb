// Share of three by three pixels of a map that the sun sees, moved with the point, so that no pixel shows; `at`: place in
// pixels, `begins`: row where the map begins. Pixels are fetched one by one: a filtered depth is none.
float open(vec2 at, float depth, int begins) {
  vec2 first = floor(at - 0.5), rest = at - 0.5 - first;
  float seen = 0.0;
  for (int i = -1; i <= 2; i++) {
    float column = i < 0 ? 1.0 - rest.x : (i > 1 ? rest.x : 1.0);
    for (int j = -1; j <= 2; j++) {
      float row = j < 0 ? 1.0 - rest.y : (j > 1 ? rest.y : 1.0);
      ivec2 pixel = clamp(ivec2(first) + ivec2(i, j), 0, SHADOW_PIXELS - 1) + ivec2(0, begins);
      seen += column * row / 9.0 * step(texelFetch(shade, pixel, 0).r, depth);
    }
  }
  return seen;
}
