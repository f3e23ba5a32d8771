#!/usr/bin/env bash
# Seeded defects of the source: each patch in tests/defects is applied to a copy of the tree, and the test that its
# first line names, `# rejected by: Suite.Name`, must fail there and pass without it. Prints a table; exits with 1
# where a defect survives, or where its test says nothing: it crashed, or took more than a quarter of an hour.
#
#   scripts/seeded_defects.sh [PATCH...]     all of tests/defects without arguments
#   scripts/seeded_defects.sh --check        builds nothing: all apply, and their tests are there
#
# The copy and its build lie in build/defects and are kept: a second run builds only what a patch touches.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

copy=$PWD/build/defects log=$PWD/build/defects.log
applied=$PWD/build/defects.applied  # the last patch that the copy was built with
export CCACHE_BASEDIR=$copy CCACHE_NOHASHDIR=1
mode=judge
[ "${1:-}" != --check ] || { mode=check; shift; }
patches=("$@")
[ $# -gt 0 ] || patches=(tests/defects/*.patch)

test_of() { sed -n 's/^# rejected by: *//p' "$1" | head -1; }

# The executable of a test: that of the folder whose source holds it.
target_of() {
    local file
    file=$(grep -lzE "TEST[A-Z_]*\(${1%%.*},\s*${1#*.}\)" tests/*/*_test.cpp | tr '\0' '\n' | head -1)
    [ -n "$file" ] && echo "test_$(basename "$(dirname "$file")")"
}

# To the copy, whatever repository it lies in.
apply() { GIT_CEILING_DIRECTORIES=$(dirname "$copy") git -C "$copy" apply "$@"; }

build() { (cd "$copy" && cmake --build --preset release --parallel "$(nproc)" --target "$1") > "$log" 2>&1; }

run() { timeout 900 "$copy/build/release/tests/$1" --gtest_filter="$2" > "$log" 2>&1; }

# Copies what git tracks or could, with its times, and removes what is no more. What the last run has compiled with its
# last patch is new again, so that it is compiled without it.
copy_sources() {
    mkdir -p "$copy"
    git ls-files -z --cached --others --exclude-standard | tar c --null --ignore-failed-read -T - 2> /dev/null |
        tar x -C "$copy"
    comm -23 <(cd "$copy" && find . -path ./build -prune -o -type f -printf '%P\n' | sort) \
        <(git ls-files --cached --others --exclude-standard | sort) | (cd "$copy" && xargs -r -d '\n' rm)
    if [ -f "$applied" ]; then
        sed -n 's|^+++ b/||p' "$applied" | (cd "$copy" && xargs -r -d '\n' touch)
        rm "$applied"
    fi
}

declare -A passing  # tests that pass without a defect

# Sets `verdict` on a patch.
judge() {
    local patch=$1 name target
    name=$(test_of "$patch")
    target=$(target_of "$name") || { verdict="NO SUCH TEST"; return; }
    if [ -z "${passing[$name]:-}" ]; then
        build "$target" || { verdict="BROKEN BUILD"; return; }
        run "$target" "$name" || { verdict="FAILS WITHOUT IT"; return; }
        grep -q "PASSED.* 1 test" "$log" || { verdict="NO SUCH TEST"; return; }
        passing[$name]=yes
    fi
    apply "$(realpath "$patch")" 2> "$log" || { verdict="DOES NOT APPLY"; return; }
    cp "$patch" "$applied"
    verdict=REJECTED
    if ! build "$target"; then
        verdict="DOES NOT COMPILE"
    elif run "$target" "$name"; then
        verdict=SURVIVED
    elif ! grep -q '^\[  FAILED  \]' "$log"; then
        verdict="NO VERDICT"
    fi
    apply -R "$(realpath "$patch")"
}

if [ $mode = check ]; then
    status=0
    for patch in "${patches[@]}"; do
        target_of "$(test_of "$patch")" > /dev/null || { echo "$patch: there is no such test" >&2; status=1; }
        GIT_CEILING_DIRECTORIES=$(dirname "$PWD") git apply --check "$patch" ||
            { echo "$patch: does not apply" >&2; status=1; }
    done
    [ $status -ne 0 ] || echo "seeded_defects: all ${#patches[@]} apply, and their tests are there"
    exit $status
fi

copy_sources
(cd "$copy" && cmake --preset release) > "$log" 2>&1 || { cat "$log" >&2; exit 2; }
status=0
printf '%-16s  %-44s  %s\n' verdict defect "rejected by"
for patch in "${patches[@]}"; do
    judge "$patch"
    [ "$verdict" = REJECTED ] || status=1
    printf '%-16s  %-44s  %s\n' "$verdict" "$(basename "$patch" .patch)" "$(test_of "$patch")"
done
exit $status
