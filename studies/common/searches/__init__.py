"""Searches for what an accuracy costs: scenes, what is true of them, ways, and who gets there at least cost."""
