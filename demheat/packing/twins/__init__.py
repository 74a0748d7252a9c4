"""Twins: pairs of particles mirrored in the interfaces of a scene, whose radical facets lie on them."""
