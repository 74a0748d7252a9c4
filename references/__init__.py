"""Witnesses beside the DEM: finite elements, FFT homogenisation, exact solutions and bounds.

A method may also lie in a folder `references` elsewhere on Python's path, as a file of its own.
"""

from pkgutil import extend_path

__path__ = extend_path(__path__, __name__)
