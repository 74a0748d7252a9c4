"""Lines of the table of grains."""

import pandas as pd

from studies.harness.pick import pick


def table(df):
    """Conductivities over the medium's (of contacts: conductances), errors, and what is missing, in k of the medium.

    At a gap of 0.3 more is missing of body-centred arrays than at 0.1: their second neighbours, 0.42 apart there, are
    0.66 apart here, beyond the widest gap of a pair, half a radius.
    """
    found = []
    for (kind, gap), rows in pick(df, part="array").groupby(["kind", "gap"], sort=False):
        found.append(_line(f"{kind}, gap {gap:g}", rows))
    for contact, rows in pick(df, part="contact").groupby("contact", sort=False):
        found.append(_line(f"contact {contact:g}", rows))
    for fraction, rows in pick(df, part="bed").groupby("fraction", sort=False):
        means = rows.groupby("contrast")[["k_ratio", "exact_ratio", "error_percent", "missing"]].mean().reset_index()
        found.append(_line(f"{rows['realisation'].nunique()} random beds, f = {fraction:g}", means))
    return pd.DataFrame(found)


def _line(text, rows):
    line = {"grains of radius 1": text}
    for row in rows.to_dict("records"):
        bare = row["contrast"] != row["contrast"] or row["contrast"] is None
        at = "vacuum" if bare else f"contrast {row['contrast']:g}"
        numbers = f"{row['k_ratio']:.4g}, {row['exact_ratio']:.4g}, {row['error_percent']:+.2g} %"
        line[f"{at}: network, continuum, error{'' if bare else ', missing'}"] = (
            numbers if bare else f"{numbers}, {row['missing']:.2f}"
        )
    return line
