#!/usr/bin/env bash
# The public headers are light: a file that includes burnish/burnish.h compiles in less than a second more than one with <vector>,
# <string> and <functional>, and what it includes belongs to the compiler's or the C library, or to burnish/. Each header compiles
# by itself.
#
#   headers_test.sh COMPILER INCLUDE_FOLDER             the test
#   headers_test.sh COMPILER INCLUDE_FOLDER --self-test headers that break each rule, which it must reject
set -euo pipefail

script=${BASH_SOURCE[0]} compiler=$1 include=$2
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
compile() { "$compiler" -std=c++20 -I"$include" -Wall -Wextra -Werror "$@"; }

# What a defective copy of the headers must be rejected for, and the line that makes it so.
self_test() {
    local name
    for name in "third-party:#include <fmt/format.h>" "slow:#include <regex>
inline bool slow(const std::string& s) { return std::regex_match(s, std::regex(s)) || !std::regex_replace(s, std::regex(s), s).empty(); }" "packet:#include \"core/packet.h\"" "incomplete:inline std::thread thread_of_nobody;"; do
        rm -rf "$tree/copy"
        mkdir -p "$tree/copy/core"
        cp -r "$include/burnish" "$tree/copy/"
        echo "#pragma once" >"$tree/copy/core/packet.h"
        sed -i '/#pragma once/q' "$tree/copy/burnish/error.h"
        { echo "${name#*:}"; sed '1,/#pragma once/d' "$include/burnish/error.h"; } >>"$tree/copy/burnish/error.h"
        if "$script" "$compiler" "$tree/copy" >"$tree/log.txt" 2>&1; then
            echo "headers_test: a header that is ${name%%:*} is accepted" >&2
            exit 1
        fi
        echo "headers_test: rejected as it must be, ${name%%:*}: $(head -1 "$tree/log.txt" | cut -c1-100)"
    done
}
if [ "${3:-}" = --self-test ]; then self_test; exit; fi

for header in "$include"/burnish/*.h; do
    echo "#include \"burnish/$(basename "$header")\"" >"$tree/one.cpp"
    compile -fsyntax-only "$tree/one.cpp" 2>"$tree/log.txt" || { echo "$header: $(head -5 "$tree/log.txt")" >&2; exit 1; }
done

echo '#include <burnish/burnish.h>' >"$tree/light.cpp"
printf '#include <vector>\n#include <string>\n#include <functional>\n' >"$tree/empty.cpp"
# Folders of the compiler and of the C library; the C++ library's is that of <vector>.
compile -E "$tree/empty.cpp" >"$tree/empty.ii"
files_of() { sed -n 's/^# [0-9]* "\([^"<]*\)".*/\1/p' "$1" | sort -u; }
library=$(files_of "$tree/empty.ii" | grep -E '/vector$' | head -1)
compile -E "$tree/light.cpp" >"$tree/light.ii"
own=$(cd "$include" && pwd)
foreign=$(files_of "$tree/light.ii" | while read -r file; do
    case $file in
        "$tree"/* | "$include"/burnish/* | "$own"/burnish/*) ;;
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
[ -z "$foreign" ] || { printf 'burnish/burnish.h includes what is neither of the standard library nor of burnish/:\n%s\n' "$foreign" >&2; exit 1; }

# Seconds of processor time of a compilation: less moved by what else runs than seconds on the clock.
seconds() {
    local TIMEFORMAT='%U %S'
    { time compile -c "$1" -o "$tree/out.o"; } 2>&1 | awk '{ print $1 + $2 }'
}
for _ in 1 2 3 4 5; do echo "$(seconds "$tree/light.cpp") $(seconds "$tree/empty.cpp")"; done |
    awk '{ print $1 - $2 }' | sort -n | awk '
        { difference[NR] = $1 }
        END {
            printf "headers_test: burnish/burnish.h takes %.2f s more than three standard headers (median of %d)\n", difference[int((NR + 1) / 2)], NR
            exit !(difference[int((NR + 1) / 2)] < 1)
        }'
