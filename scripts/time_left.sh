#!/usr/bin/env bash
# Copies the output of ctest and says behind each finished test how long the rest will take: from the times of the tests in an
# earlier run of this build, where there is one, corrected by how fast this run is; otherwise from the number of tests left.
#
#   ctest ... | time_left.sh COSTS NAMES    COSTS: ctest's CTestCostData.txt; NAMES: a file with what `ctest -N` prints
set -euo pipefail

declare -A cost  # milliseconds
if [ -f "$1" ]; then
    while read -r name milliseconds; do cost[$name]=$milliseconds; done < <(
        awk '$1 == "---" { exit } NF == 3 { printf "%s %d\n", $1, $3 * 1000 }' "$1")
fi
unknown=1000  # of a test that has not run yet
left=0
while read -r name; do left=$((left + ${cost[$name]:-$unknown})); done < <(sed -n 's/^ *Test *#[0-9]*: //p' "$2")

finished=0
begin=$SECONDS
pattern='^ *[0-9]+/[0-9]+ Test +#[0-9]+: ([^ ]+) '
while IFS= read -r line; do
    if [[ $line =~ $pattern ]]; then
        name=${BASH_REMATCH[1]}
        finished=$((finished + ${cost[$name]:-$unknown}))
        left=$((left - ${cost[$name]:-$unknown}))
        [ $left -gt 0 ] || left=0
        elapsed=$((SECONDS - begin))
        if [ $elapsed -ge 5 ] && [ $finished -gt 0 ]; then
            seconds=$((left * elapsed / finished))
            line+=$(printf '  %d:%02d left' $((seconds / 60)) $((seconds % 60)))
        fi
    fi
    printf '%s\n' "$line"
done
