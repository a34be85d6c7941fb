"""Solid bodies and walls in the water, absorbing zones, emitters, and the area exposed to the air."""
