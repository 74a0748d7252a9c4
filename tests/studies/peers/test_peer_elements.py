"""Finite elements of others on our mesh: the same equations, so the same conductivity."""

from importlib import import_module

import pytest

from references import fem
from studies.peers import given, meshes

PROGRAMS = ("freefem", "getdp", "calculix", "sfepy", "getfem", "fenics")
SIZE = 0.2
# CalculiX prints seven digits; the solvers of the others leave 1e-11.
CLOSE = {"calculix": 6e-7}


def there(name):
    program = import_module(f"studies.peers.programs.{name}")
    if program.missing():
        pytest.skip(program.missing())
    return program


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", PROGRAMS)
def test_same_mesh_same_answer(name, order):
    program, scene = there(name), given.scene("sphere 10")
    ours = fem.solve(scene, size=SIZE, order=order, curved=False, tolerance=1e-11)
    found = program.solve(scene, size=SIZE, order=order)
    assert found.conductivity == pytest.approx(ours.conductivity, rel=CLOSE.get(name, 1e-9))
    assert found.unknowns == ours.stats["unknowns"]
    assert min(found.cost[column] for column in ("wall_s", "cpu_s", "peak_mib")) >= 0
    assert program.version()


@pytest.mark.parametrize("name", PROGRAMS)
def test_refuses_other_walls(name):
    """Before anything is run, so that the program need not be there."""
    program = import_module(f"studies.peers.programs.{name}")
    drawn = given.scene("sphere 10")
    turned = type(drawn)(drawn.size, drawn.matrix, drawn.inclusions, walls={"y-": 1.0, "y+": 0.0})
    with pytest.raises(NotImplementedError, match="two across x"):
        program.solve(turned, size=SIZE)


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("freefem", ["conductivity[11] = 1;", "conductivity[12] = 10;", "on(1, T=1)", "on(2, T=0)"]),
        ("getdp", ["Body = Region[{11, 12}]", "k[Region[11]] = 1; k[Region[12]] = 10;", "Region Hot; Value 1;"]),
        ("calculix", ["*SOLID SECTION, ELSET=PHASE12, MATERIAL=OF12", "XMIN, 11, 11, 1\n", "XMAX, 11, 11, 0\n"]),
    ],
)
def test_what_programs_are_told(name, lines):
    program, scene = import_module(f"studies.peers.programs.{name}"), given.scene("sphere 10")
    mesh = meshes.conforming(scene, size=SIZE)
    text = program.script(scene, mesh, 1) if name == "freefem" else program.script(scene, mesh)
    assert [line for line in lines if line not in text] == []


def test_calculix_own_results():
    """As the suite prints them."""
    text = """
 temperatures for set NALL and time  0.1000000E+01

         1  2.000000E+01

 heat generation for set NALL and time  0.1000000E+01

         1  1.500000E+01
         2 -4.000000E+01
         3  2.500000E+01

 heat flux (elem, integ.pnt.,qx,qy,qz) for set EALL and time  0.1000000E+01

         1   1  3.000000E+00  0.000000E+00  0.000000E+00
"""
    calculix = import_module("studies.peers.programs.calculix")
    assert calculix.entering(text) == 40.0
    if calculix.missing() or not calculix.SUITE.exists():
        pytest.skip("CalculiX or its suite of tests is not installed")
    found, documented, _ = calculix.own()
    # Seven digits a node.
    assert found == pytest.approx(documented, rel=1e-6)
