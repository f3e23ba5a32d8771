#!/usr/bin/env bash
# The public headers are light: a file that includes burnish/burnish.h compiles in less than three times what one with <vector>,
# <string> and <functional> takes, and what it includes belongs to the compiler's or the C library, or to burnish/. Each header compiles
# by itself.
#
#   headers_test.sh COMPILER INCLUDE_FOLDER             the test
#   headers_test.sh COMPILER INCLUDE_FOLDER --self-test headers that break each rule, which it must reject
set -euo pipefail
export LC_ALL=C  # numbers with a point, of awk and of TIMEFORMAT

compiler=$1 include=$2 repeats=5
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
compile() { "$compiler" -std=c++20 -I"$include" -Wall -Wextra -Werror "$@"; }

# The rules, each a function that says what breaks it and fails.

# Each header compiles by itself.
complete() {
    local header
    for header in "$include"/burnish/*.h; do
        [ "$(basename "$header")" != mpi.h ] || continue  # needs MPI, which only its own target does
        echo "#include \"burnish/$(basename "$header")\"" >"$tree/one.cpp"
        compile -fsyntax-only "$tree/one.cpp" 2>"$tree/log.txt" || { echo "$header: $(head -5 "$tree/log.txt")" >&2; return 1; }
    done
}

# What is included belongs to the compiler's or the C library, or to burnish/.
standard() {
    local library own foreign
    # Folders of the compiler and of the C library; the C++ library's is that of <vector>.
    compile -E "$tree/empty.cpp" >"$tree/empty.ii"
    files_of() { sed -n 's/^# [0-9]* "\([^"<]*\)".*/\1/p' "$1" | sort -u; }
    library=$(files_of "$tree/empty.ii" | grep -E '/vector$' | head -1)
    compile -E "$tree/light.cpp" >"$tree/light.ii"
    own=$(cd "$include" && pwd)
    foreign=$(files_of "$tree/light.ii" | while read -r file; do
        case $file in
            "$tree"/*.cpp | "$include"/burnish/* | "$own"/burnish/*) ;;
            "$(dirname "$library")"/* | */x86_64-linux-gnu/c++/* | */aarch64-linux-gnu/c++/* | */lib/gcc/* | */lib/clang/*) ;;
            */include/*-linux-gnu/bits/* | */include/*-linux-gnu/sys/* | */include/*-linux-gnu/gnu/* | */include/*-linux-gnu/asm/*) ;;
            /usr/include/asm-generic/* | /usr/include/linux/*) ;;
            *)  # the C library's own headers lie in /usr/include itself, as other packages' do: by name
                case $(basename "$file") in
                    alloca.h | assert.h | ctype.h | endian.h | errno.h | features.h | features-time64.h | inttypes.h | libintl.h | limits.h | \
                    locale.h | math.h | pthread.h | sched.h | semaphore.h | signal.h | stdc-predef.h | stdint.h | stdio.h | stdlib.h | \
                    string.h | strings.h | syscall.h | time.h | unistd.h | wchar.h | wctype.h)
                        [ "$(dirname "$file")" = /usr/include ] || echo "$file" ;;
                    *) echo "$file" ;;
                esac ;;
        esac
    done)
    [ -z "$foreign" ] || { printf 'burnish/burnish.h includes what is neither of the standard library nor of burnish/:\n%s\n' "$foreign" >&2; return 1; }
}

# Seconds of processor time of a compilation.
seconds() {
    local TIMEFORMAT='%U %S'
    { time compile -c "$1" -o "$tree/out.o"; } 2>&1 | awk '{ print $1 + $2 }'
}

# burnish/burnish.h takes less than three times what three standard headers take. A ratio of least times, measured in turns: what else
# the machine does only ever adds to a time, and how fast it is concerns both.
fast() {
    for _ in $(seq "$repeats"); do echo "$(seconds "$tree/light.cpp") $(seconds "$tree/empty.cpp")"; done | awk '
        NR == 1 || $1 < light { light = $1 }
        NR == 1 || $2 < empty { empty = $2 }
        END {
            printf "headers_test: burnish/burnish.h takes %.2f s, three standard headers %.2f s (least of %d)\n", light, empty, NR
            exit !(light < 3 * empty)
        }'
}

echo '#include <burnish/burnish.h>' >"$tree/light.cpp"
printf '#include <vector>\n#include <string>\n#include <functional>\n' >"$tree/empty.cpp"

# A copy of the headers with a line that breaks a rule, and the rule that must reject it.
expect_rejected() {
    local rule=$1 line=$2 log
    rm -rf "$tree/copy"
    mkdir -p "$tree/copy/core"
    cp -r "$include/burnish" "$tree/copy/"
    echo "#pragma once" >"$tree/copy/core/packet.h"
    { sed '/#pragma once/q' "$include/burnish/error.h"; echo "$line"; sed '1,/#pragma once/d' "$include/burnish/error.h"; } \
        >"$tree/copy/burnish/error.h"
    if log=$(include=$tree/copy && "$rule" 2>&1); then
        echo "headers_test: not rejected as not $rule: $line" >&2
        exit 1
    fi
    echo "headers_test: rejected as it must be, not $rule: $(head -1 <<<"$log" | cut -c1-100)"
}

if [ "${3:-}" = --self-test ]; then
    expect_rejected complete "inline std::thread thread_of_nobody;"
    expect_rejected standard "#include <fmt/format.h>"
    expect_rejected standard '#include "core/packet.h"'
    repeats=1
    # Seconds on any machine; each constant stays below the compilers' limits of steps.
    expect_rejected fast "#include <utility>
template <unsigned S> constexpr unsigned slow = [] { unsigned n = S; for (unsigned i = 0; i < 90000; ++i) n += i ^ n; return n; }();
template <unsigned... S> constexpr unsigned sum(std::integer_sequence<unsigned, S...>) { return (0u + ... + slow<S>); }
inline constexpr unsigned total = sum(std::make_integer_sequence<unsigned, 24>());"
else
    complete
    standard
    fast
fi
