"""No kind of ship yet."""
