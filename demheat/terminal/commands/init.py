"""`demheat init`: a scene to begin with, written with comments that say what else may stand in its places."""

from demheat.runtime.paths import check_target, replaced

USUAL = "scene.toml"
TEXT = """\
# A bead of glass in epoxy between a warm wall and a cold one. Every number may say its unit, at its key
# (radius_um = 300) or as text (radius = "0.3 mm"); one without is SI. `demheat --help` lists units and formats.
#
#     demheat solve @ --method fft       its conductivity, with an interval
#     demheat compare @ --methods fft,fem,exact
#     demheat effective @                the tensor, by the method that is cheapest
#     demheat view @                     pictures

size_mm = [1, 1, 1]
matrix = "epoxy"
# domain = "cylinder-y"               # or "sphere"; for solutions in time alone

[materials.epoxy]
conductivity = "0.195 W/(m K)"
# density_g_cm3 = 1.2                 # these two for solutions in time alone
# heat_capacity_J_gK = 1.1

[materials.glass]
conductivity = 1.05                   # or along three axes: [1, 1, 5], turned by rotation_deg = [0, 0, 30]
# conductivity_at = [["20 degC", "1.05 W/(m K)"], ["100 degC", "1.2 W/(m K)"]]    # instead, if it follows that

[[inclusions]]                        # painted in order, one over the other
shape = "sphere"                      # "layer", "cylinder", "ellipsoid", "box", "torus", "half-space", "union"
center_mm = [0.5, 0.5, 0.5]
radius_um = 300
material = "glass"
# resistance = "1e-6 m2 K/W"          # of its surface

# [[inclusions]]                      # spheres of a file: columns x_mm,y_mm,z_mm,radius_mm; or a dump of LAMMPS, ...
# file = "beads.csv"                  # radius_factor = 0.99 or join = true where they overlap
# material = "glass"

# [[inclusions]]                      # a body by its surface, closed, of triangles
# shape = "surface mesh"
# file = "part.stl"                   # .ply, .obj, .msh
# unit = "mm"                         # of its coordinates; offset_mm = [0.5, 0.5, 0.5] moves it
# material = "glass"

[walls]                               # the other four are insulated; or gradient_K_mm = [0, 1, 0] of a periodic cell
"y-" = "25 degC"                      # or {flux_kW_m2 = 3}, {coefficient = "750 W/(m2 K)", temperature_C = 20}
"y+" = "35 degC"

# Instead of size, matrix and inclusions an image, whose labels name the materials: [materials.0], [materials.255]
# [image]
# file = "scan.tif"                   # .npy, .mhd, .nrrd, .zarr
# voxel_um = 2
# threshold = 112                     # of grey values: below is label 0; also crop, coarsen, labels = {pore = [0, 3]}

[solve.fft]                           # methods for `solve` and `compare` where the command names none, their knobs
voxels = 32
"""


def run(options) -> int:
    """Write the scene; the exit status."""
    path = check_target(options.scene)
    if path.exists():
        raise ValueError(f"{path}: is there already; must be another name, or be moved away")
    with replaced(path) as part:
        part.write_text(TEXT.replace("@", str(path)), encoding="utf-8")
    print(f"written {path}; try: demheat solve {path}")
    return 0
