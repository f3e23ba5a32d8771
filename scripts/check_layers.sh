#!/usr/bin/env bash
# Checks what the source files include. A folder of src/ includes its own files and those of the folders
# before it; the public headers stand alone; a third-party library is named in one place; no two units include
# each other, directly or in a longer circle (a unit is a header with its source file). Prints file:line for
# every violation and exits with 1 where there is one.
#
# check_layers.sh             checks this repository
# check_layers.sh --self-test seeds violations into a temporary tree and checks that each is found
set -euo pipefail
script=$(readlink -f "${BASH_SOURCE[0]}")

# To add a layer or a library, edit the tables in BEGIN. A layer's entry lists what it may include; the
# shading maths do not know how scene files are read. Headers of src/ are named from src/
# ("paths/trace.h"), those of the other folders from the root ("cli/text.h"), public ones "burnish/...".
# shellcheck disable=SC2016  # awk reads the dollar signs
rules='
BEGIN {
    allowed["burnish"]     = " burnish "
    allowed["core"]        = " burnish core "
    allowed["image"]       = " burnish core image "
    allowed["scene"]       = " burnish core image scene "
    allowed["shading"]     = " burnish core image scene shading "
    allowed["mitsuba"]     = " burnish core image scene shading mitsuba "
    allowed["paths"]       = " burnish core image scene shading mitsuba paths "
    allowed["render"]      = allowed["paths"] "render "
    allowed["gradient"]    = allowed["render"] "gradient "
    allowed["texture"]     = allowed["gradient"] "texture "
    allowed["optimize"]    = allowed["texture"] "optimize "
    allowed["live"]        = allowed["optimize"] "live "
    # The algorithm once more: of the layers above paths only what theta is.
    allowed["reference"]   = allowed["paths"] "gradient reference "
    allowed["scenes"]      = " burnish core image scene mitsuba scenes "
    allowed["experiments"] = allowed["optimize"] "reference scenes experiments "
    allowed["captures"]    = " burnish core image captures "
    allowed["models"]      = " burnish core image scene shading models "
    allowed["cli"]         = allowed["experiments"] "captures models live cli "
    allowed["python"]      = allowed["optimize"] "scenes captures models python "
    # Programs of several processes: what they are made of, and the public API.
    allowed["mpi"]         = " burnish cli "

    library["^embree[0-9]*/"]                            = "^src/paths/"
    library["^(tbb|oneapi)/"]                            = "^src/core/parallel[^/]*$"
    library["^(OpenEXR/|Imath/|Imf|Imath|Iex|half[.]h)"] = "^src/image/"
    library["^(png|jpeglib|jerror)[.]h$"]                = "^src/image/"
    library["^(stb/)?stb_"]                              = "^src/image/"
    library["^(pugixml|tiny_obj_loader)[.]h"]            = "^src/mitsuba/"
    library["^zlib[.]h$"]                                = "^src/mitsuba/"
    library["^(CLI|spdlog)/"]                            = "^(cli|bench)/"
    library["^nlohmann/"]                                = "^(captures|models|cli|bench)/"
    library["^xxhash[.]h"]                               = "^src/core/hash[.]cpp$"
    library["^(sys/socket|netdb|poll|netinet/.*)[.]h$"]  = "^src/live/connection[.]cpp$"
    library["^mpi[.]h$"]                                 = "^(include/burnish/mpi[.]h|mpi/)"
    library["^(fmt)/"]                                   = "^(src|captures|cli|experiments|scenes|python)/"
    library["^(nanobind/|Python[.]h)"]                   = "^python/"
}
function report(text) {
    printf "%s:%d: %s\n", FILENAME, FNR, text
    violations++
}
function layer_of(path) {
    sub(/^(src|include)\//, "", path)
    sub(/\/.*/, "", path)
    return path
}
# Whether the name is one of our headers: of a known layer, or of the public API.
function is_own(name) { return name ~ /\// && layer_of(name) in allowed }
/^[ \t]*#[ \t]*include[ \t]*["<]/ {
    header = $0
    sub(/^[ \t]*#[ \t]*include[ \t]*["<]/, "", header)
    sub(/[">].*/, "", header)
    from = layer_of(FILENAME)
    if (!(from in allowed)) {
        report("the folder \"" from "\" is no layer; layers are listed in scripts/check_layers.sh")
        next
    }
    if (is_own(header)) {
        to = layer_of(header)
        if (index(allowed[from], " " to " ") == 0)
            report("layer \"" from "\" includes " header " of layer \"" to "\", which it may not know")
        next
    }
    for (pattern in library) {
        if (header ~ pattern) {
            if (FILENAME !~ library[pattern])
                report("includes " header ", which belongs to files that match " library[pattern])
            next
        }
    }
    if ($0 ~ /include[ \t]*"/)
        report("includes \"" header "\"; own headers are named with their folder")
    else if (from == "burnish" && header !~ /^[a-z_0-9]+$/)
        report("the public header includes " header ", which is not of the standard library")
}
END { exit violations > 0 }
'

# Follows the includes of every unit, depth first; an arrow to a unit that is still open closes a circle.
# shellcheck disable=SC2016
circles='
function unit_of(path) {
    sub(/^(src|include)\//, "", path)
    sub(/[.][a-z]+$/, "", path)
    return path
}
function visit(unit, trail,    parts, i) {
    state[unit] = 1
    split(arrows[unit], parts, " ")
    for (i = 1; i in parts; i++) {
        if (parts[i] in state && state[parts[i]] == 1) {
            printf "%s: includes %s, which includes it again: %s %s\n", \
                place[unit, parts[i]], parts[i], trail, parts[i]
            violations++
        } else if (!(parts[i] in state)) {
            visit(parts[i], trail " " parts[i])
        }
    }
    state[unit] = 2
}
{
    unit = unit_of(FILENAME)
    units[++count] = unit
}
/^[ \t]*#[ \t]*include[ \t]*"/ {
    header = $0
    sub(/^[^"]*"/, "", header)
    sub(/".*/, "", header)
    to = unit_of(header)
    unit = unit_of(FILENAME)
    if (to != unit && !((unit, to) in place)) {
        place[unit, to] = FILENAME ":" FNR
        arrows[unit] = arrows[unit] " " to
    }
}
END {
    for (i = 1; i <= count; i++)
        if (!(units[i] in state)) visit(units[i], units[i])
    exit violations > 0
}
'

check() {  # check ROOT
    local files folders=() status=0
    cd "$1"
    for folder in src include captures cli experiments models scenes python mpi; do
        if [ -d "$folder" ]; then folders+=("$folder"); fi
    done
    files=$(find "${folders[@]}" -name '*.h' -o -name '*.cpp' | LC_ALL=C sort)
    awk "$rules" $files || status=1
    awk "$circles" $files || status=1
    return $status
}

self_test() {
    local expected found
    tree=$(mktemp -d)  # global: the trap outlives this function
    trap 'rm -rf "$tree"' EXIT
    mkdir -p "$tree"/src/{core,image,mitsuba,shading,paths,gradient/reservoirs} \
        "$tree"/{scenes,cli,experiments,include/burnish}
    cd "$tree"
    echo '#include "core/vec.h"' >src/image/good.cpp
    echo '#include "burnish/image.h"' >src/core/good.cpp
    echo '#include <embree3/rtcore.h>' >src/paths/good.cpp
    echo '#include <tbb/parallel_for.h>' >src/core/parallel.cpp
    echo '#include <CLI/CLI.hpp>' >cli/good.cpp
    printf '#include <vector>\n#include "burnish/options.h"\n' >include/burnish/solve.h
    echo '#include "gradient/reservoirs/merge.h"' >experiments/good.cpp
    echo '#include "paths/good.h"' >src/paths/good_user.h
    if ! check "$tree"; then
        echo "check_layers: the self-test found a violation in a clean tree" >&2
        return 1
    fi
    printf '#include <vector>\n#include "image/image.h"\n' >src/core/upward.cpp
    echo '#include "render/film.h"' >src/mitsuba/sideways.cpp
    echo '  #  include <tbb/parallel_for.h>' >src/core/threads.cpp
    echo '#include <embree4/rtcore.h>' >cli/rays.cpp
    echo '#include <nlohmann/json.hpp>' >src/image/json.cpp
    echo '#include "shading/texture.h"' >scenes/light.cpp
    echo '#include "near.h"' >src/shading/unrooted.cpp
    echo '#include <zlib.h>' >src/image/inflate.cpp
    echo '#include "core/vec.h"' >include/burnish/heavy.h
    echo '#include <fmt/format.h>' >include/burnish/format.h
    echo '#include "cli/text.h"' >experiments/aloud.cpp
    echo '#include "paths/lights.h"' >src/paths/accel.h
    echo '#include "paths/surface.h"' >src/paths/lights.cpp
    echo '#include "paths/accel.h"' >src/paths/surface.h
    expected='cli/rays.cpp:1
experiments/aloud.cpp:1
include/burnish/format.h:1
include/burnish/heavy.h:1
scenes/light.cpp:1
src/core/threads.cpp:1
src/core/upward.cpp:2
src/image/inflate.cpp:1
src/image/json.cpp:1
src/mitsuba/sideways.cpp:1
src/paths/surface.h:1
src/shading/unrooted.cpp:1'
    found=$(bash "$script" --root "$tree" | cut -d: -f1,2 | LC_ALL=C sort || true)
    if [ "$found" != "$expected" ]; then
        printf 'check_layers: the self-test expected\n%s\nand found\n%s\n' "$expected" "$found" >&2
        return 1
    fi
    if bash "$script" --root "$tree" >/dev/null; then
        echo "check_layers: the self-test found violations but the exit status is 0" >&2
        return 1
    fi
    echo "check_layers: self-test passed: 12 seeded violations found"
}

case "${1:-}" in
    --self-test) self_test ;;
    --root) check "$2" ;;
    '') check "$(dirname "$script")/.." && echo "check_layers: every file keeps to its layer, no circle of includes" ;;
    *) echo "usage: check_layers.sh [--self-test]" >&2; exit 2 ;;
esac
