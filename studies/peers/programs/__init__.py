"""Programs that others wrote, a file each.

A file declares

- `TITLE`, how it is called; `KIND`, what it is given: "image", "mesh", "network", "packing" or "body";
- `GET`, how it is installed: "pip: ..." or "apt: ...";
- `CASES`, dicts of a "scene" (`studies.peers.given.SCENES`) and plain knobs, its resolution (`n`, `voxels`, `particles`
  or `size`) among them;
- `CANNOT`, what it cannot do: {in a few words: why};
- `EXPLAINED`, what of its error its own convention explains, or "";
- `missing()`, None or the reason why it cannot run here, with "not installed" or "no Python here has" in it, by which a
  replay knows that it says nothing of a stored row; `version()`;
- `solve(scene, **knobs)`, an `outside.Found`, or NotImplementedError in one line;
- `own()`, where its documentation prints a value: (found, documented, where that stands).
"""
