#!/usr/bin/env bash
# Instructions per step of each mode of benches/skipping.rs, by callgrind (valgrind must be installed):
# the difference between a run of 20 and one of 10 steps, which leaves out set-up and reading of files.
# Then, for each absent part, the program with its slot, filled with `()`, against one that has no such slot. Fails if any costs more than 2 %.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v valgrind >/dev/null || { echo "valgrind is not installed; no instructions counted" >&2; exit 1; }
binary=$(cargo build --quiet --release --bench skipping --message-format=json |
    sed -n 's/.*"name":"skipping".*"executable":"\([^"]*\)".*/\1/p')
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

count() { # mode steps
    RAYON_NUM_THREADS=1 valgrind --tool=callgrind --callgrind-out-file="$out/$1.$2" "$binary" "$1" "$2" 2>&1 >/dev/null |
        awk '/Collected/ { print $4 }'
}

declare -A per
printf '%-20s %17s %10s\n' mode instructions/step "of plain"
for mode in plain hooks nobody fixed moving apart scalar_by_hand scalar closure_by_hand closure contactless; do
    few=$(count "$mode" 10)
    many=$(count "$mode" 20)
    per[$mode]=$(((many - few) / 10))
    printf '%-20s %17d %10s\n' "$mode" "${per[$mode]}" "$(awk -v a="${per[$mode]}" -v b="${per[plain]}" 'BEGIN { printf "%.4f", a / b }')"
done

failed=0
compare() { # absent part, program with the slot, leaner program
    verdict=$(awk -v a="${per[$2]}" -v b="${per[$3]}" 'BEGIN { printf "%.4f %s", a / b, (a <= 1.02 * b) ? "pass" : "FAIL" }')
    [[ $verdict == *pass ]] || failed=1
    printf '%-8s %-12s %17d   %-20s %17d %8s %s\n' "$1" "$2" "${per[$2]}" "$3" "${per[$3]}" $verdict
}
printf '\n%-8s %-12s %17s   %-20s %17s %8s at most 1.02\n' absent "slot is ()" instructions/step "no slot" instructions/step ratio
compare bodies nobody plain
compare closure scalar scalar_by_hand
compare scalar closure closure_by_hand
compare all hooks plain
exit $failed
