#!/usr/bin/env bash
# Installs the Debian and Ubuntu packages that Burnish is built with. Says which ones are missing before it
# installs them; says and does nothing when all are there. Works as root and with sudo.
set -euo pipefail

packages=(
    g++ cmake ninja-build ccache
    libembree-dev libtbb-dev
    libopenexr-dev libpng-dev zlib1g-dev libjpeg-dev libstb-dev
    libpugixml-dev libtinyobjloader-dev
    libcli11-dev libfmt-dev libspdlog-dev nlohmann-json3-dev
    libxxhash-dev
    git libgtest-dev libbenchmark-dev
    openmpi-bin libopenmpi-dev
    python3-dev python3-venv
)

fail() {
    printf 'setup: %s\n' "$*" >&2
    exit 1
}

command -v dpkg-query >/dev/null && command -v apt-get >/dev/null ||
    fail "this system has no apt-get; install what these Debian packages hold by its own means," \
        "then build by hand (see CONTRIBUTING.md): ${packages[*]}"

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

become_root=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null ||
        fail "neither root nor sudo is at hand; as root run: apt-get install ${missing[*]}"
    become_root=(sudo)
fi

printf 'setup: installing %s\n' "${missing[*]}"
apt() {
    ${become_root[@]+"${become_root[@]}"} env DEBIAN_FRONTEND=noninteractive \
        apt-get -o DPkg::Lock::Timeout=300 -y "$@"
}
apt update || fail "apt-get update failed (see above); these packages are missing: ${missing[*]}"
apt install --no-install-recommends "${missing[@]}" ||
    fail "apt-get could not install all of: ${missing[*]}"
