"""What was expected before there were any searches, as claims."""

from studies.common.searches import means

# Set before any search: the DEM the cheapest for any shape, to so many per cent, on so many scenes.
GUESSES = {"conductivity": (0.1, 8), "flux": (1.0, 8)}


def guess(df, quantity):
    """Of whom it was guessed, before any search, that it costs least."""
    target, least = GUESSES[quantity]
    column = f"{quantity}_{target:g}_s"
    if column not in df or not df[column].notna().any():
        return
    count = len(means.wins(df, quantity, target, means.scenes_of(df)).get("dem", ()))
    # As it was guessed: ties count, and so does each contrast of a body.
    text = f"Scenes on which the DEM is the cheapest for any shape, or ties, to {target:g} % of the {quantity}"
    yield text, count, f">= {least}"
