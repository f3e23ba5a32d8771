#!/usr/bin/env bash
# Checks that no file is longer than 350 lines and no function longer than 60. A function, or another block of a
# namespace's or a class's scope, ends with a closing brace at the indentation of the line that it began with:
# clang-format lays the sources out so. Tables (blocks of initialisers) do not count as functions. Prints
# file:line for every violation and exits with 1 where there is one.
#
# check_sizes.sh             checks this repository
# check_sizes.sh --self-test seeds violations into a temporary tree and checks that each is found
set -euo pipefail
script=$(readlink -f "${BASH_SOURCE[0]}")

# A block opens on a line that ends with "{". `depth` counts braces outside of comments, strings and characters.
# A block is a container, whose own length does not count, where its head says namespace, class, struct, union,
# enum or extern, or where it initialises something ("= {", "kName{").
# shellcheck disable=SC2016  # awk reads the dollar signs
rules='
function end_file() {
    if (lines > 350) {
        printf "%s:351: the file has %d lines, expected at most 350\n", file, lines
        violations++
    }
}
# The line without comments, strings and character literals.
function code_of(line) {
    gsub(/\\./, "", line)
    gsub(/"[^"]*"/, "", line)
    gsub(/\047.\047/, "", line)
    sub(/\/\/.*/, "", line)
    return line
}
FNR == 1 { if (file != "") end_file(); file = FILENAME; depth = 0; inside = 0; head = "" }
{
    lines = FNR
    code = code_of($0)
    if (code ~ /^[ \t]*#/) next
    opened = gsub(/[{]/, "{", code)
    closed = gsub(/[}]/, "}", code)
    if (!inside) {
        head = head " " code
        is_container = head ~ /(^|[ \t])(namespace|class|struct|union|enum|extern)[ \t]/ && head !~ /[)][^{;]*[{][^{]*$/
        is_table = head ~ /(=[ \t]*|[A-Za-z0-9_>])[{][ \t]*$/
        if (opened > closed && !is_container && !is_table) {
            inside = 1; start = FNR; outer = depth
        }
        if (code ~ /[;{}][ \t]*$/ || code ~ /:[ \t]*$/) head = ""
    }
    depth += opened - closed
    if (inside && depth <= outer) {
        if (FNR - start + 1 > 60) {
            printf "%s:%d: the function has %d lines, expected at most 60\n", FILENAME, start, FNR - start + 1
            violations++
        }
        inside = 0
        head = ""
    }
}
END {
    if (file != "") end_file()
    exit violations > 0
}
'

check() {  # check ROOT
    local folders=()
    cd "$1"
    for folder in src include captures cli experiments models mpi scenes python; do
        if [ -d "$folder" ]; then folders+=("$folder"); fi
    done
    find "${folders[@]}" -name '*.h' -o -name '*.cpp' | LC_ALL=C sort | xargs -r awk "$rules"
}

lines() {  # lines COUNT TEXT
    for ((i = 0; i < $1; i++)); do echo "$2"; done
}

self_test() {
    local expected found
    tree=$(mktemp -d)  # global: the trap outlives this function
    trap 'rm -rf "$tree"' EXIT
    mkdir -p "$tree"/{src/core,cli,include/burnish,mpi}
    cd "$tree"
    { echo 'void f() {'; lines 58 '    g("}");  // }'; echo '}'; } >src/core/function.cpp
    { echo 'constexpr int kTable[] = {'; lines 100 '    1,'; echo '};'; } >cli/table.cpp
    { echo 'namespace a {'; echo 'struct S {'; lines 100 '    int x;'; echo '};'; echo '}  // namespace a'; } \
        >include/burnish/struct.h
    lines 350 'int x;' >src/core/file.h
    if ! check "$tree"; then
        echo "check_sizes: the self-test found a violation in a clean tree" >&2
        return 1
    fi
    lines 351 'int x;' >src/core/long_file.h
    lines 351 'int x;' >mpi/long_file.cpp
    { echo 'namespace a {'; echo; echo 'void f() {'; lines 59 '    g();'; echo '}'; echo '}  // namespace a'; } \
        >src/core/long_function.cpp
    { echo 'struct S {'; echo '    int f(int a,'; echo '          int b) const {'; lines 30 '        if (a) {'
        lines 30 '        }'; echo '    }'; echo '};'; } >cli/long_member.h
    expected='cli/long_member.h:3
mpi/long_file.cpp:351
src/core/long_file.h:351
src/core/long_function.cpp:3'
    found=$(bash "$script" --root "$tree" | cut -d: -f1,2 | LC_ALL=C sort || true)
    if [ "$found" != "$expected" ]; then
        printf 'check_sizes: the self-test expected\n%s\nand found\n%s\n' "$expected" "$found" >&2
        return 1
    fi
    if bash "$script" --root "$tree" >/dev/null; then
        echo "check_sizes: the self-test found violations but the exit status is 0" >&2
        return 1
    fi
    echo "check_sizes: self-test passed: 4 seeded violations found"
}

case "${1:-}" in
    --self-test) self_test ;;
    --root) check "$2" ;;
    '') check "$(dirname "$script")/.." && echo "check_sizes: no file over 350 lines, no function over 60" ;;
    *) echo "usage: check_sizes.sh [--self-test]" >&2; exit 2 ;;
esac
