"""From a user's text to a checked scene."""
