"""Meshes and fields for ParaView (the only home of meshio)."""

from demheat.runtime.extras import extra


def write(path, mesh, field=None):
    """Write a mesh for ParaView or another format that meshio knows by its suffix."""
    with extra("writing a mesh"):
        import meshio

    points, cells = {}, {"phase": [mesh.phase]}
    if field is not None:
        points["temperature"] = field.temperature_at(mesh.points)
        cells["flux"] = [field.flux_at(mesh.points[mesh.cells[:, :4]].mean(axis=1))]
    kind = "tetra" if mesh.cells.shape[1] == 4 else "tetra10"
    meshio.Mesh(mesh.points, [(kind, mesh.cells)], point_data=points, cell_data=cells).write(path)
