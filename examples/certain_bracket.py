"""A certain bracket: bounds that no discretisation error can cross, closer and closer, and who lies between them.

python examples/certain_bracket.py
"""

from demheat import Layer, Material, Scene, Sphere, solve
from references import bracket, fft

# A ball above a poor layer, between two walls: no closed form.
ball = Sphere((0.5, 0.5, 0.6), 0.25, Material(20.0))
coat = Layer(2, 0.0, 0.2, Material(0.2))
scene = Scene((1.0, 1.0, 1.0), Material(1.0), [coat, ball], walls={"z-": 0.0, "z+": 1.0})

for knobs in ({"size": 0.25}, {"width": 7e-4}):  # a mesh, or as many as it takes
    found = bracket.solve(scene, **knobs)
    bounds = f"{found.lower:.6f} to {found.upper:.6f} W/(m K)"
    print(f"{bounds}, {100 * found.width:.3f} % wide, {found.stats['elements']} elements")

for name, field in {"FFT": fft.solve(scene, voxels=32), "DEM": solve(scene, particles=4_000)}.items():
    inside = found.lower <= field.conductivity <= found.upper
    error = field.error
    print(f"{name} {field.conductivity:.6f}, expects {error.lower:.6f} to {error.upper:.6f}; in the bracket: {inside}")
print("A method may lie outside: its own interval says by how much it may be off, the bracket where the truth is.")
