#!/usr/bin/env bash
# SPDX-License-Identifier: MIT OR Apache-2.0
# dxc.sh [FOLDER]: puts a program `dxc` into FOLDER, target/dxc by default, that compiles HLSL with the DirectX Shader Compiler.
# Its library is taken from the Python package compushady, whose archive on PyPI holds one for Linux on x86-64.
set -euo pipefail
cd "$(dirname "$0")/.."

folder="${1-target/dxc}"
version=0.17.5
inside="compushady-$version/compushady/backends/libdxcompiler_x86_64.so.3.7"
checksum=fb549976da7abff1ee56bdfa4f5ab156b95e971d4270b5b4447b61682d105809

if [ "$(uname -sm)" != "Linux x86_64" ]; then
    echo "dxc: there is a library for Linux on x86-64 only; install the Vulkan SDK" >&2
    exit 1
fi
mkdir -p "$folder"
library="$folder/libdxcompiler.so"
if ! echo "$checksum  $library" | sha256sum --check --status 2>/dev/null; then
    downloads="$(mktemp -d)"
    trap 'rm -rf "$downloads"' EXIT
    # Of the archive only the library is taken; nothing is installed.
    python3 -m pip download --quiet --no-deps --no-binary compushady --dest "$downloads" "compushady==$version"
    tar -xzOf "$downloads/compushady-$version.tar.gz" "$inside" >"$library"
    echo "$checksum  $library" | sha256sum --check --quiet
fi
cp scripts/dxc.py "$folder/dxc"
chmod +x "$folder/dxc"
echo "dxc: $folder/dxc"
