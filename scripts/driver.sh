#!/usr/bin/env bash
# SPDX-License-Identifier: MIT OR Apache-2.0
# Finds what Airlight needs of the system, and installs it where that is possible and allowed.
#
#   scripts/driver.sh           a Vulkan driver: the GPU's, or Debian's software driver where there is none
#   scripts/driver.sh --tools   spirv-val and the validation layer as well; what cannot be had is reported, not an error
#   scripts/driver.sh --check   install nothing: say what is there, exit 1 where no driver is
set -euo pipefail

tools=no
install=yes
for argument in "$@"; do
    case "$argument" in
        --tools) tools=yes ;;
        --check) install=no ;;
        *)
            echo "driver.sh: $argument is no option; options are --tools and --check" >&2
            exit 2
            ;;
    esac
done

PATH="$PATH:/usr/sbin:/sbin"

# Whether the shared library $1 can be found by the loader.
has_library() {
    # No pipe: `grep -q` would end `ldconfig` early, which `pipefail` takes for a failure.
    local cache
    cache="$(ldconfig -p 2>/dev/null || true)"
    case "$cache" in *"$1"*) return 0 ;; esac
    local folder
    for folder in ${LD_LIBRARY_PATH:+$(tr ':' ' ' <<<"$LD_LIBRARY_PATH")} \
        /usr/local/lib /usr/lib /usr/lib64 /usr/lib/*-linux-gnu /lib /lib64; do
        if [ -e "$folder/$1" ]; then return 0; fi
    done
    return 1
}

# The manifests of installed Vulkan drivers, one a line.
driver_manifests() {
    local chosen="${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}" folder file
    if [ -n "$chosen" ]; then
        tr ':' '\n' <<<"$chosen"
        return
    fi
    if [ -n "${VK_ADD_DRIVER_FILES:-}" ]; then tr ':' '\n' <<<"$VK_ADD_DRIVER_FILES"; fi
    for folder in "${XDG_CONFIG_HOME:-$HOME/.config}" /etc/xdg /usr/local/etc /etc \
        "${XDG_DATA_HOME:-$HOME/.local/share}" /usr/local/share /usr/share; do
        for file in "$folder"/vulkan/icd.d/*.json; do
            if [ -e "$file" ]; then echo "$file"; fi
        done
    done
}

# Whether the driver of manifest $1 has its library, and the device that it drives.
usable() {
    local library
    [ -r "$1" ] || return 1
    library="$(sed -n 's/.*"library_path"[[:space:]]*:[[:space:]]*"\([^"]*\)".*/\1/p' "$1" | head -n 1)"
    case "$library" in
        '') return 1 ;;
        /*) [ -e "$library" ] || return 1 ;;
        */*) [ -e "$(dirname "$1")/$library" ] || return 1 ;;
        *) has_library "$library" || return 1 ;;
    esac
    case "$library" in
        *lvp* | *swiftshader*) return 0 ;;
    esac
    local device
    for device in /dev/dri/renderD* /dev/nvidia[0-9]* /dev/dxg /dev/mali0 /dev/kgsl-3d0; do
        if [ -r "$device" ] && [ -w "$device" ]; then return 0; fi
    done
    return 1
}

found=
find_driver() {
    has_library libvulkan.so.1 || return 1
    local manifest
    while read -r manifest; do
        if [ -n "$manifest" ] && usable "$manifest"; then
            found="$manifest"
            return 0
        fi
    done < <(driver_manifests)
    return 1
}

# The command that gives apt-get the rights it needs; fails where there is none.
as_root() {
    command -v apt-get >/dev/null || return 1
    if [ "$(id -u)" -eq 0 ]; then
        env DEBIAN_FRONTEND=noninteractive "$@"
    elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
        sudo -n env DEBIAN_FRONTEND=noninteractive "$@"
    else
        return 1
    fi
}

# Installs packages, with fresh package lists only if it does not work with those that are there.
apt_install() {
    [ "$install" = yes ] || return 1
    as_root true 2>/dev/null || return 1
    echo "driver: installing $*"
    as_root apt-get install -y -qq --no-install-recommends "$@" >/dev/null 2>&1 && return 0
    as_root apt-get update -qq || true
    as_root apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

case "$(uname -s)" in
    Darwin)
        echo "driver: Metal is part of macOS, nothing to install"
        ;;
    Linux)
        if ! find_driver; then
            apt_install mesa-vulkan-drivers libvulkan1 || true
            if ! find_driver; then
                echo "driver: no Vulkan driver found; install your GPU's, or the software one: Debian/Ubuntu 'apt install mesa-vulkan-drivers libvulkan1', Fedora 'dnf install mesa-vulkan-drivers vulkan-loader', Arch 'pacman -S vulkan-swrast vulkan-icd-loader', macOS nothing, Windows the vendor's graphics driver" >&2
                exit 1
            fi
        fi
        echo "driver: $found"
        if ! command -v cc >/dev/null && ! command -v gcc >/dev/null && ! command -v clang >/dev/null; then
            apt_install gcc libc6-dev || {
                echo "driver: Rust needs a C linker; install gcc" >&2
                exit 1
            }
        fi
        ;;
    *)
        echo "driver: on this system Vulkan comes with the vendor's graphics driver; install that if there is no adapter"
        ;;
esac

if [ "$tools" = yes ]; then
    command -v spirv-val >/dev/null || apt_install spirv-tools || true
    for tool in spirv-val tint; do
        if path="$(command -v "$tool")"; then
            echo "driver: $path"
        elif [ "$tool" = tint ]; then
            echo "driver: tint is not on the PATH; it is built from Dawn's source, no package has it"
        else
            echo "driver: spirv-val is not on the PATH; install spirv-tools"
        fi
    done
    layer="$(dirname "$0")/validation_layer.sh"
    "$layer" --check >/dev/null 2>&1 || apt_install vulkan-validationlayers || true
    "$layer" --check || true
fi
