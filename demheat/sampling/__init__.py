"""Temperature and flux anywhere, from what a solved network knows at its particles."""
