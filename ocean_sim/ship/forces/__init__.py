"""Forces on a ship: added mass, damping, radiation, propulsion and moorings."""
