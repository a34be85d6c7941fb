"""The water around a hull: samples of waves, contact with particles and with walls."""
