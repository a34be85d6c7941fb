"""What the seas share."""
