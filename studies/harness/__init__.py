"""What runs, times, keeps, judges and draws the studies."""
