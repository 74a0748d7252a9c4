"""What all computing runs on: compiled code and its threads, limits of memory and time, progress, files in place."""
