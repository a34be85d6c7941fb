"""No kind of surface yet."""
