#!/usr/bin/env bash
# Runs the fuzzers of the readers, each for so many seconds, as many at a time as there are processors. Prints a line for
# each: what it has run, what it has found. Exits with 1 where one has found something: a failure, or a file that takes
# two seconds.
#
#   scripts/fuzz.sh SECONDS [READER...]      all readers of tests/fuzz/readers.cpp without names
#
# What widens the corpus is kept in build/fuzz/corpus, what makes a reader fail or take two seconds in build/fuzz/findings.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() { echo "fuzz: $1" >&2; exit 2; }

[[ "${1:-}" =~ ^[1-9][0-9]*$ ]] || fail "found '${1:-}', expected seconds for each reader"
seconds=$1
shift
command -v clang++ >/dev/null || fail "there is no clang++: expected Debian's package clang"

cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --parallel "$(nproc)"
[ $# -gt 0 ] || set -- $(basename -a build/fuzz/tests/fuzz_* | sed 's/^fuzz_//')

run() {  # run READER
    local reader=$1 own=build/fuzz/corpus/$1 findings=build/fuzz/findings/$1 log=build/fuzz/$1.log
    local options=(-max_total_time="$seconds" -timeout=10 -report_slow_units=2 -rss_limit_mb=4096 -malloc_limit_mb=2560
        -print_final_stats=1 -dict="tests/fuzz/$reader.dict")
    mkdir -p "$own" "$findings"
    local result="no finding" status=0
    # By its absolute name: some readers work in a folder of their own.
    build/fuzz/tests/fuzz_"$reader" "${options[@]}" -artifact_prefix="$PWD/$findings/" "$own" \
        "tests/fuzz/corpus/$reader" >"$log" 2>&1 || status=$?
    [ "$(sed -n 's/^stat::slowest_unit_time_sec: *//p' "$log")" -lt 2 ] 2>/dev/null || status=1
    [ $status -eq 0 ] || result="FAILED, see $log; again: build/fuzz/tests/fuzz_$reader $(ls -t "$findings"/* 2>/dev/null | head -1)"
    printf '%-24s %10s files, %6s edges, %s\n' "$reader" \
        "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" \
        "$(grep -o 'cov: [0-9]*' "$log" | tail -1 | cut -d' ' -f2)" "$result"
    return $status
}
export -f run
export seconds ASAN_OPTIONS=${ASAN_OPTIONS:-allocator_may_return_null=0} UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
printf '%s\n' "$@" | xargs -P "$(nproc)" -I{} bash -c 'run {}' || exit 1
