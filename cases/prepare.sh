# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash disable=SC2034
# For cases/run and tests/run: installs Debian packages that are missing, and builds. Sourced, from the top folder.

build_packages=(gcc libc6-dev meson ninja-build pkg-config libxml2-dev zlib1g-dev libudunits2-dev libmuparser-dev libsundials-dev)

# install_missing PACKAGE...: with apt, only what dpkg does not know as installed.
install_missing() {
    local package missing=() sudo=()
    for package in "$@"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    [ "$(id -u)" -eq 0 ] || sudo=(sudo)
    echo "installing: ${missing[*]}"
    "${sudo[@]}" apt-get update -qq
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# build FOLDER [MESON OPTION]...: sets the folder up once and compiles it, quietly unless something is wrong.
build() {
    local folder=$1
    shift
    if [ ! -f "$folder/build.ninja" ]; then
        meson setup "$@" "$folder" >"/tmp/calx-setup.$$" 2>&1 || { cat "/tmp/calx-setup.$$"; return 1; }
        rm -f "/tmp/calx-setup.$$"
    fi
    meson compile -C "$folder" >"$folder/compile.log" 2>&1 || { cat "$folder/compile.log"; return 1; }
}
