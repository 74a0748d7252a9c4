"""The cheapest way to an accuracy: what each method's error and cost will be, before anything is solved."""

from demheat.cheapest.effective import Effective, Recommendation, effective, recommend

__all__ = ["Effective", "Recommendation", "effective", "recommend"]
