"""The geometry of a hull: shapes, meshes, voxels, and the cubes that carry forces."""
