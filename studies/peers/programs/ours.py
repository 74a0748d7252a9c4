"""Our own linear solver on the same network, beside those of others: conjugate gradients, by the diagonal or multigrid.

`demheat.conduction.steady.solve_steady` from the same first temperatures; its tolerance of 1e-10 is on the heat that
passes, which left 0.1 to 1.1 times that of the right-hand side. Its cost is of the call, assembly from the network,
islands and wall heats included, in this process; what is compiled is loaded before.
"""

from studies.peers import networks
from studies.peers.outside import Found

TITLE = "demheat, its linear solver"
KIND = "network"
GET = "here"
CANNOT = {}
EXPLAINED = "all of it: the error is that of our network, whoever solves it"
CASES = networks.cases(("cg", "amg"))
# Of the network that loads the compiled kernels.
SMALL = 1000


def missing():
    """Nothing."""
    return None


def version():
    """None: rows have their commit."""
    return ""


def solve(scene, *, particles, solver="cg"):
    """Solve our network of a body."""
    from demheat.conduction.steady import solve_steady
    from studies.harness.cost import measured

    for number in (SMALL, particles):
        equations = networks.system(scene, number)
        solution, cost = measured(solve_steady, equations.network, scene, solver=solver, tolerance=networks.RESIDUAL)
    told = Found(None, {name: cost[name] for name in ("wall_s", "cpu_s", "peak_mib")})
    told = told._replace(iterations=solution.stats["iterations"])
    return networks.judged(equations, solution.temperature, told)
