"""The page in a browser: what it is sent and may ask, the server behind it, and replays that need none."""
