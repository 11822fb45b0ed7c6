"""One solve by one peer in a process of its own: `solve.py METHOD PROBLEM.npz COUNT SETTINGS VALUES.npy`.

SETTINGS is an object: `tol`, and for SLEPc what its functions below name. Prints one object: processor seconds of the
solve, and in bytes the memory before it and the most there was.
"""

import json
import sys
import time

import numpy as np


def memory(field):
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) * 1024 for line in status if line.startswith(field))


def sparse(data):
    import scipy.sparse as sp

    n = int(data["n"])
    shape = (data["indices"], data["indptr"])
    stiffness = sp.csc_matrix((data["stiffness"], *shape), shape=(n, n))
    mass = sp.identity(n, format="csc") / n if data["unit"] else sp.csc_matrix((data["mass"], *shape), shape=(n, n))
    return stiffness, mass


def by_scipy(data, count, settings):
    """eigsh as its users call it: shift-invert with its own factorisation (SuperLU) and basis (2k + 1), eigenvalues only."""
    import scipy.sparse.linalg as sla

    stiffness, mass = sparse(data)
    if data["unit"]:
        n, mass = stiffness.shape[0], None
        stiffness = stiffness * n
    basis = 2 * count + 1 + settings.get("more", 0)
    options = {"sigma": settings.get("shift", -0.01), "ncv": basis, "tol": settings["tol"], "rng": settings["seed"]}
    yield
    yield sla.eigsh(stiffness, k=count, M=mass, return_eigenvectors=False, **options)


def by_lapy(data, count, settings):
    """LaPy's Solver with CHOLMOD on the given matrices; its eigenvectors, which it always asks for, are let go."""
    import lapy.solver

    solver = lapy.solver.Solver.__new__(lapy.solver.Solver)
    solver.stiffness, solver.mass = sparse(data)
    solver.use_cholmod = True
    eigsh = lapy.solver._eigsh

    def values_only(stiffness, k, mass, **options):
        options |= {"tol": settings["tol"], "return_eigenvectors": False}
        return eigsh(stiffness, k, mass, **options), np.empty((0, k))

    lapy.solver._eigsh = values_only
    yield
    yield solver.eigs(k=count, rng=settings["seed"])[0]


def slepc(data, options):
    import slepc4py

    slepc4py.init([sys.argv[0], *options])
    from petsc4py import PETSc
    from slepc4py import SLEPc

    n = int(data["n"])

    def matrix(values):
        made = PETSc.Mat().createAIJ((n, n), csr=(data["indptr"], data["indices"], values))
        made.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        made.assemble()
        return made

    solver = SLEPc.EPS().create(PETSc.COMM_SELF)
    if data["unit"]:
        solver.setOperators(matrix(data["stiffness"] * n))
        solver.setProblemType(SLEPc.EPS.ProblemType.HEP)
    else:
        solver.setOperators(matrix(data["stiffness"]), matrix(data["mass"]))
        solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    solver.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
    return SLEPc, solver


def factor(settings):
    """Options for the factorisation: `package` mumps or petsc, and the `ordering` that belongs to it."""
    yield from ("-options_left", "no")
    yield from ("-st_type", "sinvert", "-st_ksp_type", "preonly", "-st_pc_type", "cholesky")
    yield from ("-st_pc_factor_mat_solver_type", settings["package"])
    if settings["package"] == "petsc":
        yield from ("-st_pc_factor_mat_ordering_type", settings["ordering"])
    else:
        # No parallel factorisation of the root, without which MUMPS counts no inertia.
        yield from ("-st_mat_mumps_icntl_13", "1", "-mat_mumps_icntl_13", "1")
        yield from ("-st_mat_mumps_icntl_7", str(settings["ordering"]))


def eigenvalues(solver):
    return np.array([solver.getEigenvalue(index).real for index in range(solver.getConverged())])


def by_krylov(data, count, settings):
    """SLEPc's Krylov-Schur method around one shift."""
    module, solver = slepc(data, list(factor(settings)))
    solver.setWhichEigenpairs(module.EPS.Which.TARGET_MAGNITUDE)
    solver.setTarget(-0.01)
    solver.setTolerances(tol=settings["tol"])
    solver.setDimensions(count)
    solver.setFromOptions()
    yield
    solver.solve()
    yield eigenvalues(solver)


def by_slicing(data, count, settings):
    """SLEPc's spectrum slicing of (-1, `end`); `nev` and `ncv` are those of a slice."""
    module, solver = slepc(data, list(factor(settings)))
    solver.setWhichEigenpairs(module.EPS.Which.ALL)
    solver.setInterval(-1.0, settings["end"])
    solver.setKrylovSchurDimensions(settings["nev"], settings["ncv"], settings["ncv"])
    solver.setTolerances(tol=settings["tol"])
    solver.setFromOptions()
    yield
    solver.solve()
    yield eigenvalues(solver)


def main():
    method, problem, count, settings, out = sys.argv[1:]
    data = dict(np.load(problem))
    steps = globals()["by_" + method](data, int(count), json.loads(settings))
    next(steps)
    before = memory("VmRSS")
    start = time.process_time()
    values = next(steps)
    seconds = time.process_time() - start
    peak = memory("VmHWM")
    np.save(out, np.sort(values))
    print(json.dumps({"processor": seconds, "before": before, "peak": peak}))


main()
