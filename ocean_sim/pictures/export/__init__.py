"""Files of drawn runs for ParaView, Blender and browsers."""
