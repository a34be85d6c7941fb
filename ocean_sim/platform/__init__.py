"""No kind of platform yet."""
