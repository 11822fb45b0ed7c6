#!/usr/bin/env bash
# What the solver's time goes into, by part, and how near each part is to what one core can do.
#
#     tests/bench/parts.sh [--rounds N] [--counts 50,100,500,1000] [--choice fem|lumped|cot] [MESH…]
#
# Without a mesh procedural ones of about 2 500, 10 000 and 50 000 vertices are made. Needs Python 3 and a C compiler.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
options=() meshes=()
while [[ $# -gt 0 ]]; do
    case $1 in
        --*) options+=("$1" "$2") && shift 2 ;;
        *) meshes+=("$(realpath "$1")") && shift ;;
    esac
done
cd "$here/../.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
bench=$(cargo bench --quiet --locked --no-run --bench spectrum --message-format json |
    sed -n 's/.*"kind":\["bench"\].*"executable":"\([^"]*\)".*/\1/p')
cc -O3 -march=native -mprefer-vector-width=512 -funroll-loops "$here/machine.c" -o "$scratch/machine"
if [[ ${#meshes[@]} -eq 0 ]]; then
    for vertices in 2500 10000 50000; do
        cargo run --quiet --release --locked --bin tui -- synth "$scratch/$vertices" --models 1 --classes hand \
            --vertices $vertices >/dev/null
        meshes+=("$(find "$scratch/$vertices" -name '*.obj')")
    done
fi
python3 "$here/parts.py" "$bench" "$scratch/machine" "${options[@]}" "${meshes[@]}"
