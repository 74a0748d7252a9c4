"""The image of 500^3 voxels that TauFactor published, by what it is found by: the file itself is not shipped."""

SHAPE, PAGES = (500, 500, 500), "TF-500x500x500-1x2x6-v3.tiff"
# As the paper prints them; columns of the TIFF are x, rows y, pages z.
SHARE, TORTUOSITY = 0.3, {"x": 1.3905, "y": 1.1513, "z": 4.2431}
# Of the printed digits, and of a domain that is one voxel too long or too short, as some programs have it.
PRINTED, ONE_VOXEL = 5e-5, 1 / 500
WHERE = (
    "github.com/tldr-group/taufactor, docs/paper/TF-500x500x500-1x2x6-v3.tiff.zip (3992922 bytes, SHA-256 "
    "ccd04a9e9a96a400dce20e517b71f66f0b9e88dbfa52e9afc80a385d22384421), MIT licence of that repository"
)
# Of its labels as bytes, [x][y][z] with z fastest.
DIGEST = "3cf0038d425a6f5743c7411402bcc6c944fd665ddfa9450e3f985a6d23cff3fe"
HOW = (
    "share .3 of conducting voxels over the tortuosity {:g} that was printed, of TauFactor 2 converged beyond its "
    "usual tolerance: seven-point differences on these voxels between two held faces, not the continuum of the "
    "voxels nor of what they show. Not computed again here; every second voxel along each axis gives .201, .251 and "
    ".066 along x, y and z, which tells the axes apart. The error is that of the printed digits and of one voxel in 500"
)


def tables():
    """The files' tables; there is no scene without the image."""
    for axis, tortuosity in TORTUOSITY.items():
        value = SHARE / tortuosity
        error = value * (PRINTED / tortuosity + ONE_VOXEL)
        yield {
            "name": f"taufactor-500-{axis}",
            "group": "published images",
            "title": f"TauFactor's test volume, 500^3 voxels, 30 % conduct, along {axis}",
            "scene": {
                "size": (1.0, 1.0, 1.0),
                "materials": [{"label": 0, "conductivity": 0.0}, {"label": 255, "conductivity": 1.0}],
                "voxels": {"shape": SHAPE, "voxel": 1 / SHAPE[0], "where": WHERE, "file": PAGES, "sha256": DIGEST},
                "walls": {f"{axis}-": {"temperature": 1.0}, f"{axis}+": {"temperature": 0.0}},
            },
            "known": {
                "by": "published",
                "how": HOW.format(tortuosity),
                "source": "Kench, Squires and Cooper, J. Open Source Softw. 8 (2023) 5358: TauFactor 2",
                "conductivity": {"value": value, "error": float(f"{error:.1g}"), "error_is": "estimate"},
            },
        }
