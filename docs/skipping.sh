#!/usr/bin/env bash
# Instructions per step of each mode of examples/skipping, by callgrind (valgrind must be installed):
# the difference between a run of 20 and one of 10 steps, which leaves out set-up and reading of files.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v valgrind >/dev/null || { echo "valgrind is not installed; no instructions counted" >&2; exit 1; }
cargo build --quiet --release --example skipping
binary="${CARGO_TARGET_DIR:-target}/release/examples/skipping"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

count() { # mode steps
    RAYON_NUM_THREADS=1 valgrind --tool=callgrind --callgrind-out-file="$out/$1.$2" "$binary" "$1" "$2" 2>&1 >/dev/null |
        awk '/Collected/ { print $4 }'
}

printf '%-8s %16s %10s\n' mode instructions/step "of plain"
for mode in plain hooks nobody fixed moving apart; do
    few=$(count "$mode" 10)
    many=$(count "$mode" 20)
    per=$(((many - few) / 10))
    [ "$mode" = plain ] && plain=$per
    printf '%-8s %16d %10s\n' "$mode" "$per" "$(awk -v a="$per" -v b="$plain" 'BEGIN { printf "%.4f", a / b }')"
done
for mode in fixed moving apart; do "$binary" "$mode" 20; done
