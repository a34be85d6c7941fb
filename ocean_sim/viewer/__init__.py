"""The page in a browser: its protocol, its server, and replays that need no server."""
