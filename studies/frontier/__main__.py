"""`python -m studies.frontier`: what all searches are foreseen to take."""

from studies.common.searches.scenes import HELD_BACK, SCENES
from studies.frontier.cases import all_cases, foreseen

number = sum(1 for _ in all_cases())
print(f"{number} searches, {len(SCENES)} scenes ({len(HELD_BACK)} held back): at most {foreseen():.0f} CPU-minutes")
