"""Lines of the study's table: a scene each."""

import pandas as pd

from demheat import referee
from studies.formless import walked
from studies.formless.verdicts import with_elements

NAN = float("nan")


def table(df):
    """Conductivity over the matrix's by the finest elements, the others' distance from it, %, bounds and verdicts.

    Of walkers half of their interval besides, %, and whose values it does not hold; of a good labyrinth they are those
    of the bad one that is the rest of the cell. Bounds are of the fractions that the method has, of checkerboards those
    of admissible fields on voxels.
    """
    judged = walked.judged(df)
    scenes = with_elements(df).groupby(["part", "contrast", "fraction"], sort=False, dropna=False)
    return pd.DataFrame([_line(df, judged, scene, group) for scene, group in scenes])


def _line(df, judged, scene, group):
    part, contrast, fraction = scene
    own = walked.finest(group)
    elements = own[own["size"].notna()]
    first = (elements if len(elements) else group).iloc[0]
    line = {"part": part, "contrast": contrast, "fraction": fraction, "elements": first["k_ratio"]}
    for title in ("DEM", "FFT"):
        apart = group[group["name"].map(walked.TITLES) == title]["apart_percent"]
        line[title] = float(apart.iloc[0]) if len(apart) else NAN
    known, judged = walked.witness(df, *scene), judged[judged["case"].isin(own["case"])]
    line["walkers"] = 100 * referee.value_error(known[0], first["k_ratio"]) if known else NAN
    line["walkers +-"] = known[1] if known else NAN
    line["not in walkers'"] = walked.named(walked.outside(judged), judged)
    line["at least"], line["at most"] = walked.certain(df, first)
    over = own[[not walked.beyond(df, row) <= 0 for row in own.to_dict("records")]]
    return line | {"not in bounds": walked.named(over, own)}
