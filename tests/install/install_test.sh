#!/usr/bin/env bash
# Installs a build into a temporary prefix, moves it, builds the examples against it as an outside project, and runs them on a
# procedural scene. Also looks at what else is installed: the manual page and the completions name every option.
#
#   install_test.sh CMAKE BUILD SOURCE COMPILER [CXXFLAGS]
set -euo pipefail
export LC_ALL=C  # numbers with a point, of awk and of TIMEFORMAT

fail() { echo "install_test: $1" >&2; exit 1; }

cmake=$1 build=$2 source=$3 compiler=$4 flags=${5:-}
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

"$cmake" --install "$build" --prefix "$tree/installed" >"$tree/log.txt" || fail "$(tail -20 "$tree/log.txt")"
prefix=$tree/moved  # nothing may remember where it was installed
mv "$tree/installed" "$prefix"
burnish=$prefix/bin/burnish
"$burnish" --version >/dev/null || fail "the installed program does not run"

# Documents: every option of every command.
manual=$prefix/share/man/man1/burnish.1
bash_completion=$prefix/share/bash-completion/completions/burnish
zsh_completion=$prefix/share/zsh/site-functions/_burnish
fish_completion=$prefix/share/fish/vendor_completions.d/burnish.fish
bash -n "$bash_completion"
has() {  # has PROGRAM FILE
    command -v "$1" >/dev/null || { echo "install_test: no $1 here, which would check $2"; return 1; }
}
if has zsh _burnish; then zsh -n "$zsh_completion"; fi
if has fish burnish.fish; then fish -n "$fish_completion"; fi
if has groff burnish.1; then
    warnings=$(groff -ww -man -Tascii "$manual" 2>&1 >/dev/null)
    [ -z "$warnings" ] || fail "burnish.1: $warnings"
fi
help_of() { "$burnish" "$1" --help-all 2>/dev/null || "$burnish" "$1" --help; }
commands=$("$burnish" --help | awk '/ommands:/ { on = 1; next } on && /^  [a-z]/ { print $1 }')
[ "$(wc -w <<<"$commands")" -ge 4 ] || fail "found these commands only: $commands"
options=0
for command in $commands; do
    awk -v from=".SS burnish $command" '/^[.]S[SH]/ { on = $0 == from } on' "$manual" >"$tree/manual"
    grep "^        $command) " "$bash_completion" >"$tree/bash"
    sed -n "/    $command)/,/;;/p" "$zsh_completion" >"$tree/zsh"
    grep -F "from $command'" "$fish_completion" >"$tree/fish"
    for option in $(help_of "$command" | sed -n 's/^  \(-[^ ]*\).*/\1/p' | tr ',' ' '); do
        options=$((options + 1))
        grep -qF -- "${option//-/\\-}" "$tree/manual" || fail "burnish.1: $command $option is missing"
        grep -qE -- "[ \"]$option[ \"]" "$tree/bash" || fail "bash: $command $option is missing"
        grep -qF -- "'*${option}[" "$tree/zsh" || fail "zsh: $command $option is missing"
        name=${option#-}
        [[ $name == -* ]] && want="-l ${name#-} " || want="-s $name "
        grep -qF -- "$want" "$tree/fish" || fail "fish: $command $option is missing"
    done
done
[ $options -ge 40 ] || fail "found $options options only"
offered=$(bash -c 'source "$1"; COMP_WORDS=(burnish render --sp); COMP_CWORD=2; _burnish; echo "${COMPREPLY[*]}"' - "$bash_completion")
[ "$offered" = --spp ] || fail "bash completes --sp to '$offered'"
offered=$(bash -c 'source "$1"; COMP_WORDS=(burnish optimize --estimator pa); COMP_CWORD=3; _burnish; echo "${COMPREPLY[*]}"' - \
    "$bash_completion")
[ "$offered" = path_cache ] || fail "bash completes --estimator pa to '$offered'"
# A head that fills its column, and a path.
grep -q '^Between two checkpoints, ' "$manual" || fail "burnish.1: the text of --checkpoint-every is cut"
grep -q "from new' .*-l views -r -F " "$fish_completion" || fail "fish completes no files to new --views"
for status in 2 65 70 73 74 75 77; do
    grep -q "\b$status: " "$manual" || fail "burnish.1: exit status $status is missing"
done

# The examples, as an outside project.
"$cmake" -S "$source/examples" -B "$tree/examples" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$compiler" \
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Wshadow -Werror $flags" >"$tree/log.txt" 2>&1 ||
    fail "$(tail -20 "$tree/log.txt")"
"$cmake" --build "$tree/examples" --parallel 2 >"$tree/log.txt" 2>&1 || fail "$(tail -40 "$tree/log.txt")"

# A project with the policies of CMake before 3.3; CMake 4 has none of them.
mkdir "$tree/old"
printf '%s\n' 'cmake_minimum_required(VERSION 3.22)' 'project(Old CXX)' 'if(CMAKE_VERSION VERSION_LESS 4)' \
    'cmake_policy(SET CMP0057 OLD)' 'endif()' 'find_package(Burnish CONFIG REQUIRED)' >"$tree/old/CMakeLists.txt"
"$cmake" -S "$tree/old" -B "$tree/old/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$compiler" \
    >"$tree/log.txt" 2>&1 || fail "$(tail -20 "$tree/log.txt")"

# A package that Burnish needs and that is missing: it is not found, which is no error where nobody requires it, and mutes nothing.
mkdir "$tree/lacking"
cat >"$tree/lacking/CMakeLists.txt" <<'EOF'
cmake_minimum_required(VERSION 3.22)
project(Lacking CXX)
foreach(package TBB OpenEXR)
    set(CMAKE_DISABLE_FIND_PACKAGE_${package} ON)
    find_package(Burnish CONFIG QUIET)
    unset(CMAKE_DISABLE_FIND_PACKAGE_${package})
    if(Burnish_FOUND OR NOT Burnish_CONSIDERED_CONFIGS)
        message(FATAL_ERROR "without ${package}: found, or never looked for it")
    elseif(DEFINED CMAKE_MESSAGE_LOG_LEVEL)
        message(FATAL_ERROR "without ${package}: messages below ${CMAKE_MESSAGE_LOG_LEVEL} are muted")
    endif()
endforeach()
set(CMAKE_DISABLE_FIND_PACKAGE_MPI ON)
find_package(Burnish CONFIG QUIET COMPONENTS mpi)
if(Burnish_FOUND)
    message(FATAL_ERROR "the component mpi is found without MPI")
endif()
find_package(Burnish CONFIG QUIET OPTIONAL_COMPONENTS mpi)
if(NOT Burnish_FOUND)
    message(FATAL_ERROR "without MPI, of which a component is optional: not found")
endif()
EOF
"$cmake" -S "$tree/lacking" -B "$tree/lacking/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$compiler" \
    >"$tree/log.txt" 2>&1 || fail "$(tail -20 "$tree/log.txt")"

# The component of several processes, where it was built.
if [ -e "$(find "$prefix" -name BurnishMpiTargets.cmake)" ]; then
    mkdir "$tree/mpi"
    printf '%s\n' 'cmake_minimum_required(VERSION 3.22)' 'project(Mpi CXX)' \
        'find_package(Burnish CONFIG REQUIRED COMPONENTS mpi)' 'add_executable(ranks ranks.cpp)' \
        'target_link_libraries(ranks PRIVATE Burnish::burnish Burnish::mpi)' >"$tree/mpi/CMakeLists.txt"
    printf '%s\n' '#include <burnish/mpi.h>' 'int main(int argc, char** argv) {' '    MPI_Init(&argc, &argv);' \
        '    const int count = burnish::ranks_of(MPI_COMM_WORLD).count;' '    MPI_Finalize();' '    return count - 1;' '}' \
        >"$tree/mpi/ranks.cpp"
    "$cmake" -S "$tree/mpi" -B "$tree/mpi/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$compiler" \
        -DCMAKE_CXX_FLAGS="$flags" >"$tree/log.txt" 2>&1 || fail "$(tail -20 "$tree/log.txt")"
    "$cmake" --build "$tree/mpi/build" >"$tree/log.txt" 2>&1 || fail "$(tail -40 "$tree/log.txt")"
fi

# As a part of another project: no tests, no MPI where it is off although the project has it, and warnings stop nobody's build.
mkdir "$tree/whole"
printf '%s\n' 'cmake_minimum_required(VERSION 3.22)' 'project(Whole CXX)' 'find_package(MPI QUIET COMPONENTS CXX)' \
    "add_subdirectory(\"$source\" burnish)" 'if(TARGET burnish_mpi)' 'message(FATAL_ERROR "MPI is on")' 'endif()' \
    >"$tree/whole/CMakeLists.txt"
"$cmake" -S "$tree/whole" -B "$tree/whole/build" -DBURNISH_MPI=off -DCMAKE_CXX_COMPILER="$compiler" >"$tree/log.txt" 2>&1 ||
    fail "$(tail -20 "$tree/log.txt")"
for option in TESTS WERROR; do
    grep -qx "BURNISH_$option:BOOL=OFF" "$tree/whole/build/CMakeCache.txt" || fail "BURNISH_$option is on in another project"
done

# What cannot be built is said before anything is.
refused() {  # refused WORDS OPTION...
    local words=$1
    shift
    if "$cmake" -S "$source" -B "$tree/refused" -DCMAKE_CXX_COMPILER="$compiler" "$@" >"$tree/log.txt" 2>&1; then
        fail "$* is configured"
    fi
    tr -s '\n ' ' ' <"$tree/log.txt" | grep -qF "$words" || fail "$*: $(tail -20 "$tree/log.txt")"
}
refused 'BURNISH_PORTABLE: its library' -DBURNISH_PORTABLE=ON -DBURNISH_BENCH=ON
refused 'BURNISH_SANITIZE: found tsan, expected' -DBURNISH_PORTABLE=OFF -DBURNISH_SANITIZE=tsan
refused 'BURNISH_MPI: found maybe, expected' -DBURNISH_SANITIZE=OFF -DBURNISH_BENCH=OFF -DBURNISH_MPI=maybe

# The goblet's target, small, and its roughness from it.
"$burnish" scene goblet --texture-size 64 -o "$tree/goblet" >"$tree/log.txt" 2>&1 || fail "$(cat "$tree/log.txt")"
sed -i -E 's/(<default name="res[xy]" value=)"[0-9]+"/\1"48"/' "$tree/goblet/scene.xml"
[ "$(grep -c '<default name="res[xy]" value="48"' "$tree/goblet/scene.xml")" -eq 2 ] || fail "the goblet's size is not found"
"$burnish" render "$tree/goblet/scene.xml" --spp 1024 -o "$tree/target.exr" >"$tree/log.txt" 2>&1 || fail "$(cat "$tree/log.txt")"
parameter=$("$burnish" info "$tree/goblet/scene.xml" | grep -oE '[A-Za-z0-9_.-]*roughness[A-Za-z0-9_.]*' | head -1)
[ -n "$parameter" ] || fail "the goblet has no roughness"

# Runs an example; its output goes to $tree/NAME.txt.
run() {
    "$tree/examples/$1" "$tree/goblet/scene.xml" "$tree/target.exr" "$parameter" "$tree/$2" "$3" >"$tree/$1.txt" 2>&1 ||
        fail "$1: $(cat "$tree/$1.txt")"
    [ -s "$tree/$2" ] || fail "$1 wrote no $2"
}
# The first and the last loss that an example printed: the last is lower by a factor.
falls() {
    awk -v factor="$2" '
        { for (i = 1; i <= NF; i++) if ($i == "loss") { if (first == "") first = $(i + 1); last = $(i + 1) } }
        / -> / { for (i = 1; i <= NF; i++) if ($i == "->") last = $(i + 1) }
        END { exit !(first > 0 && last > 0 && last < factor * first) }' "$tree/$1.txt" ||
        fail "$1: the loss does not fall: $(cat "$tree/$1.txt")"
}
run recover_texture recovered.exr 120
falls recover_texture 0.5
run own_loss own_loss.exr 120
falls own_loss 0.5
run live_picture live.png 120
falls live_picture 0.5
run gradient_only gradient_only.exr 20
falls gradient_only 0.7
"$burnish" render "$tree/goblet/scene.xml" --size 24 24 --spp 1 -o "$tree/small.exr" >"$tree/log.txt" 2>&1 || fail "$(cat "$tree/log.txt")"
for example in recover_texture own_loss live_picture gradient_only; do
    if "$tree/examples/$example" "$tree/goblet/scene.xml" "$tree/small.exr" "$parameter" "$tree/x.exr" 1 >"$tree/log.txt" 2>&1; then
        fail "$example: a picture of another size is accepted"
    fi
    grep -qF "the film's size" "$tree/log.txt" || fail "$example: the error does not name the size: $(cat "$tree/log.txt")"
    for count in many 0 -3 5x; do
        "$tree/examples/$example" "$tree/goblet/scene.xml" "$tree/target.exr" "$parameter" "$tree/x.exr" $count >"$tree/log.txt" 2>&1 || true
        grep -qxF "ITERATIONS: expected a whole number from 1 to 4294967295, found '$count'" "$tree/log.txt" ||
            fail "$example with $count iterations: $(cat "$tree/log.txt")"
    done
done
if "$tree/examples/recover_texture" "$tree/missing.xml" a b c >"$tree/log.txt" 2>&1; then fail "a missing scene is accepted"; fi
grep -qF "$tree/missing.xml" "$tree/log.txt" || fail "the error does not name the file: $(cat "$tree/log.txt")"
echo "install_test: $options options are documented, the examples run"
