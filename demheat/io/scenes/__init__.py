"""Scenes as TOML files, with units in the names of keys or as text; every error is one line with file, line and key.

size_mm = [100, 100, 100]
matrix = "resin"

[materials.resin]
conductivity = "0.2 W/(m K)"

[materials.silica]
conductivity = 1.4  # W/(m K), as without a unit all is SI

[[inclusions]]  # painted in order; shape = "layer", axis, start, stop; "cylinder", "ellipsoid", "box", "half-space"
shape = "sphere"
center_mm = [50, 50, 50]
radius = "30 mm"
material = "silica"

[[inclusions]]  # or spheres from a file beside this one: columns x, y, z, radius and, if wanted, material
file = "spheres.csv"
unit = "mm"
material = "silica"
# radius_factor = 0.99, or join = true, where they overlap: smaller ones, or one body of each group

[walls]  # or gradient_K_mm = [0, 1, 0] of a periodic cell
"y-" = "25 degC"
"y+" = "35 degC"

[solve.fft]  # methods and their knobs, for the commands
voxels = 64

Instead of size, matrix and inclusions an image may stand, see `demheat.io.images`; its labels name the materials:

[image]
file = "grains.tif"  # .npy, .tif, .mhd, .nrrd, beside this file
voxel = "2 um"       # or voxel_um = [2, 2, 4]; MetaImages, NRRDs, TIFFs of ImageJ and OME may tell it themselves
# crop = [[0, 100], [0, 100], [20, 120]], coarsen = 2, threshold = 112 (or several) of grey values
# labels = {pore = [0, 3], rock = 255}    # of materials by their names

[materials.0]
conductivity = 0.2

[materials.255]
conductivity = 1.4
"""

from demheat.io.images import read_image  # noqa: F401 - `demheat.files` had it
from demheat.io.scenes.read import SceneFile, read, read_file
from demheat.io.scenes.write import write

__all__ = ["SceneFile", "read", "read_file", "write"]
