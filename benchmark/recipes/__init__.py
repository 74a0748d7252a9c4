"""How each scene is drawn, and by what its values are known; `benchmark.make` writes them down."""
