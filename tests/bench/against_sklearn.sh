#!/usr/bin/env bash
# The learning stages on one set of features, by this program, scikit-learn and mlxtend, on one thread: seconds, ratios.
#
#     tests/bench/against_sklearn.sh FEATURES.csv
#
# FEATURES.csv: model,class,role,f1,f2,… with role train or query, as tests/bench/features.py writes them.
# NumPy, scikit-learn and mlxtend are put into a scratch environment unless PYTHON names an interpreter that has them.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
features=$(realpath "${1:?usage: against_sklearn.sh FEATURES.csv}")
cd "$here/../.."
if [[ -z ${PYTHON:-} ]]; then
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
    python3 -m venv "$scratch/venv"
    "$scratch/venv/bin/pip" install --quiet numpy scikit-learn mlxtend
    PYTHON=$scratch/venv/bin/python
fi
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1
ours=$(cargo bench --quiet --locked --bench learning -- --json "$features")
"$PYTHON" "$here/against_sklearn.py" "$features" "$ours"
