#!/usr/bin/env bash
# A data set from an empty cache with 1, 2 and 4 threads: time, models per second, efficiency, peak memory, certificates.
#
#     tests/bench/dataset.sh [--threads "1 2 4"] [--count N] [--models N] DIR
#
# Takes the meshes that DIR/train.cla and DIR/query.cla name, or all below DIR; with --models only every so manieth, N of
# them. Needs Python 3.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
options=()
while [[ $# -gt 1 ]]; do options+=("$1" "$2") && shift 2; done
data=$(realpath "${1:?usage: dataset.sh [OPTIONS] DIR}")
cd "$here/../.."
cargo build --quiet --release --locked --bin tui
python3 "$here/dataset.py" "${CARGO_TARGET_DIR:-target}/release/tui" "${options[@]}" "$data"
