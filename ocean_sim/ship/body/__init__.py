"""The rigid body of a ship and the base classes of the kinds of ships."""
