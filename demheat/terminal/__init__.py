"""What people see in a terminal: commands, how they end, pictures and planes to draw."""
