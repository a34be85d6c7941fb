"""Colours that people with any colour vision can distinguish (Okabe & Ito 2008)."""

BLUE, ORANGE, GREEN, RED, SKY, PURPLE = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#56B4E9", "#CC79A7"
SERIES = (BLUE, RED, GREEN, PURPLE, ORANGE, SKY)  # of curves, one after the other
