"""Scenes as voxels: phases, volume fractions, normals of interfaces, links."""
