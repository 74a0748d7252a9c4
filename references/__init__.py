"""Witnesses beside the DEM: finite elements, FFT homogenisation, exact solutions and bounds."""
