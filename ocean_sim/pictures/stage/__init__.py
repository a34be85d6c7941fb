"""The stage of a picture: camera, sky, light, overlays, and objects that are neither water nor ship."""
