"""Water in a picture: surface, far sea, foam, spray, wakes and tanks."""
