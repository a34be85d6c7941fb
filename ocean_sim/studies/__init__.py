"""Studies: many runs of scenes or of validation cases, and what they say together."""
