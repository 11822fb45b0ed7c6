#!/usr/bin/env bash
# How the screen feels on a data set: from key press to frame while spectra are computed on all cores, bytes per press at
# 80×24, starts, and memory in a full session.
#
#     tests/bench/latency.sh [--presses N] [--cache DIR] [--binary FILE] DATA
#
# The program runs in a pseudo-terminal; `cat` in another one, asked in turn with it, is the floor. --cache names a cache
# for the warm start, which is filled if need be and kept; else one is made and thrown away. Needs Python 3.9.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
options=() binary=''
while [[ $# -gt 1 ]]; do
    case $1 in
        --binary) binary=$(realpath "$2") && shift 2 ;;
        *) options+=("$1" "$2") && shift 2 ;;
    esac
done
data=$(realpath "${1:?usage: latency.sh [OPTIONS] DATA}")
cd "$here/../.."
if [[ -z $binary ]]; then
    cargo build --quiet --release --locked --bin tui
    binary=${CARGO_TARGET_DIR:-target}/release/tui
fi
python3 "$here/latency.py" "${options[@]}" "$binary" "$data"
