#!/usr/bin/env bash
# CPU and wall seconds of builds, each in a target folder of its own, with crates already downloaded:
#   docs/build_cost.sh                     # all: the command, its first run, the tests, every crate
#   docs/build_cost.sh command tests dem   # some
# "incremental" is the time from a changed source file of a crate to the end of its tests.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo fetch --quiet
TIMEFORMAT='%U %S %R'

# Prints the name, CPU seconds and wall seconds of a command whose output goes to a log.
measure() { # name command...
    local name=$1 log=$CARGO_TARGET_DIR/measure.log
    shift
    { time "$@" > "$log" 2>&1 || { tail -20 "$log" >&2; exit 1; }; } 2>&1 |
        awk -v name="$name" '{ printf "%-28s %6.0f CPU s %6.0f s\n", name, $1 + $2, $3 }'
}

# Runs a function with a target folder of its own.
with_fresh_target() { # function arguments...
    local target
    target=$(mktemp -d)
    CARGO_TARGET_DIR=$target "$@"
    rm -rf "$target"
}

command_() {
    measure "command, cold" cargo build --release
    measure "first run (two_discs)" cargo run --release -- run two_discs --out "$CARGO_TARGET_DIR/out"
}

tests() {
    measure "tests, cold build" cargo test --workspace --release --no-run
    measure "tests, run" cargo test --workspace --release
}

crate() { # folder
    local package=siltflow-$1
    measure "$1, cold" cargo build --release -p "$package"
    cargo test --release -p "$package" --no-run > /dev/null 2>&1
    touch "crates/$1/src/lib.rs"
    measure "$1, incremental" cargo test --release -p "$package"
}

if [[ $# -eq 0 ]]; then
    set -- command tests interfaces fv-mesh ibm dem turb mor coupling render report scene
fi
for part; do
    case $part in
        command) with_fresh_target command_ ;;
        tests) with_fresh_target tests ;;
        *) with_fresh_target crate "$part" ;;
    esac
done
