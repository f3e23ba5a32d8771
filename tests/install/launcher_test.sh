#!/usr/bin/env bash
# What the compiler is called by: the launcher that the user names; none where ccache does not work.
#
#   launcher_test.sh CMAKE SOURCE COMPILER
set -euo pipefail

fail() { echo "launcher_test: $1" >&2; exit 1; }

cmake=$1 source=$2 compiler=$3
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

configure() { # configure BUILD [OPTION...]
    "$cmake" -G Ninja -S "$source" -B "$tree/$1" -DCMAKE_CXX_COMPILER="$compiler" -DBURNISH_TESTS=OFF \
        -DBURNISH_MPI=OFF "${@:2}" >"$tree/log.txt" 2>&1 || fail "$(tail -20 "$tree/log.txt")"
}
calls() { grep -qF "$2" "$tree/$1/build.ninja" "$tree/$1/CMakeFiles/rules.ninja"; } # calls BUILD LAUNCHER

mkdir "$tree/bin"
printf '#!/bin/sh\nexec "$@"\n' >"$tree/launcher"
printf '#!/bin/sh\nexec "$@"\n' >"$tree/bin/ccache"
chmod +x "$tree/launcher" "$tree/bin/ccache"
export PATH=$tree/bin:$PATH

configure own -DCMAKE_CXX_COMPILER_LAUNCHER="$tree/launcher"
calls own "$tree/launcher" || fail "the user's launcher is not used"
if calls own "$tree/bin/ccache"; then fail "ccache takes the place of the user's launcher"; fi

configure works
calls works "$tree/bin/ccache" || fail "a ccache that works is not used"

printf '#!/bin/sh\nexit 1\n' >"$tree/bin/ccache"
configure fails
if calls fails "$tree/bin/ccache"; then fail "a ccache that fails is used"; fi
