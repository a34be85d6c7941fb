// The far sea: the basin is drawn by its own surface.
  if (all(greaterThan(posW.xz, innerLow.xz)) && all(lessThan(posW.xz, innerHigh.xz))) discard;
