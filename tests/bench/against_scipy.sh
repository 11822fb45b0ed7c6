#!/usr/bin/env bash
# Eigenvalues of one mesh, by this program and by SciPy's eigsh in turn: processor seconds of each, and their ratio.
#
#     tests/bench/against_scipy.sh MESH.off [COUNT] [ROUNDS]
#
# NumPy and SciPy are put into a scratch environment unless PYTHON names an interpreter that has them.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mesh=$(realpath "${1:?usage: against_scipy.sh MESH.off [COUNT] [ROUNDS]}")
cd "$here/../.."
if [[ -z ${PYTHON:-} ]]; then
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
    python3 -m venv "$scratch/venv"
    "$scratch/venv/bin/pip" install --quiet numpy scipy
    PYTHON=$scratch/venv/bin/python
fi
cargo build --quiet --release --locked --bin tui
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1
"$PYTHON" "$here/against_scipy.py" "${CARGO_TARGET_DIR:-target}/release/tui" "$mesh" "${2:-500}" "${3:-3}"
