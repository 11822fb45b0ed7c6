#!/usr/bin/env bash
# How the solver's time and memory grow with the number of vertices.
#
#     tests/bench/growth.sh [--rounds N] [--count N] [--choice fem|lumped|cot] [--classes hand,octopus] [N…]
#
# Solves procedural shapes of about so many vertices (10 000, 50 000 and 200 000 without a number) on one thread, in
# turns, and prints medians of processor time, exponents between neighbouring sizes and peak memory. Needs Python 3.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rounds=3 count=500 choice=fem classes=hand,octopus sizes=()
while [[ $# -gt 0 ]]; do
    case $1 in
        --rounds) rounds=$2 && shift 2 ;;
        --count) count=$2 && shift 2 ;;
        --choice) choice=$2 && shift 2 ;;
        --classes) classes=$2 && shift 2 ;;
        *) sizes+=("$1") && shift ;;
    esac
done
[[ ${#sizes[@]} -gt 0 ]] || sizes=(10000 50000 200000)
cd "$here/../.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
bench=$(cargo bench --quiet --locked --no-run --bench spectrum --message-format json |
    sed -n 's/.*"kind":\["bench"\].*"executable":"\([^"]*\)".*/\1/p')
for size in "${sizes[@]}"; do
    cargo run --quiet --release --locked --bin tui -- synth "$scratch/$size" --models 1 --classes "$classes" \
        --vertices "$size" >/dev/null
done
for round in $(seq "$rounds"); do
    for size in "${sizes[@]}"; do
        for mesh in "$scratch/$size"/*/*/*.obj; do
            "$bench" --json --count "$count" --choice "$choice" "$mesh"
        done
    done
done | python3 "$here/growth.py"
