#!/usr/bin/env bash
# SPDX-License-Identifier: MIT OR Apache-2.0
# Runs tests that use the GPU under the Vulkan validation layer, and fails where it has anything to say.
#
#   scripts/validation_layer.sh             the snapshots, and every pass on random input
#   scripts/validation_layer.sh TEST…       other test targets of airlight-tests
#   scripts/validation_layer.sh --check     run nothing: say whether the layer is there, exit 1 where it is not
#   scripts/validation_layer.sh --provoke   with advice on best practices besides, which wgpu does not follow: must fail
set -euo pipefail
cd "$(dirname "$0")/.."

LAYER=VK_LAYER_KHRONOS_validation
check=no
provoke=no
tests=()
for argument in "$@"; do
    case "$argument" in
        --check) check=yes ;;
        --provoke) provoke=yes ;;
        -*)
            echo "validation_layer.sh: $argument is no option; options are --check and --provoke" >&2
            exit 2
            ;;
        *) tests+=("$argument") ;;
    esac
done

# The manifest of the layer, as the loader looks for it.
manifest() {
    local folder
    for folder in ${VK_LAYER_PATH:+$(tr ':' ' ' <<<"$VK_LAYER_PATH")} \
        "${XDG_CONFIG_HOME:-$HOME/.config}/vulkan/explicit_layer.d" /etc/vulkan/explicit_layer.d \
        "${XDG_DATA_HOME:-$HOME/.local/share}/vulkan/explicit_layer.d" \
        /usr/local/share/vulkan/explicit_layer.d /usr/share/vulkan/explicit_layer.d; do
        if [ -d "$folder" ] && grep -ls "\"$LAYER\"" "$folder"/*.json 2>/dev/null; then return 0; fi
    done
    return 1
}

if ! found="$(manifest)"; then
    echo "validation layer: $LAYER is not installed; install it: Debian/Ubuntu 'apt install vulkan-validationlayers', Fedora 'dnf install vulkan-validation-layers', Arch 'pacman -S vulkan-validation-layers'" >&2
    exit 1
fi
echo "validation layer: $(head -n 1 <<<"$found")"
if [ "$check" = yes ]; then exit 0; fi

[ "${#tests[@]}" -gt 0 ] || tests=(snapshots snapshots_ambient wild)
targets=()
for name in "${tests[@]}"; do targets+=(--test "$name"); done
# Built before the layer is switched on.
cargo test --release --locked --workspace "${targets[@]}" --no-run

work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
log="$work/messages"
{
    echo "khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG"
    # The layer says as information that it is active: without that line nothing was checked.
    echo "khronos_validation.report_flags = error,warn,info"
    echo "khronos_validation.log_filename = $log"
    echo "khronos_validation.duplicate_message_limit = 3"
    if [ "$provoke" = yes ]; then
        echo "khronos_validation.enables = VK_VALIDATION_FEATURE_ENABLE_BEST_PRACTICES_EXT"
    fi
} >"$work/vk_layer_settings.txt"

failed=0
for name in "${tests[@]}"; do
    : >"$log"
    # Of every pass the permutation that most use: the layer sees no more in the others, and makes all slower.
    VK_INSTANCE_LAYERS="$LAYER" VK_LAYER_SETTINGS_PATH="$work" AIRLIGHT_WILD="${AIRLIGHT_WILD-:default}" \
        cargo test --release --locked --quiet --workspace --test "$name" || failed=1
    if ! grep -q "Khronos Validation Layer Active" "$log"; then
        echo "validation layer: $name ran without the layer" >&2
        failed=1
    fi
    if grep -E "^Validation (Error|Warning|Performance Warning)|\((ERROR|WARN|PERF) /" "$log" | sort | uniq -c | sort -rn | head -n 40 >"$work/found" && [ -s "$work/found" ]; then
        echo "validation layer: messages in $name:" >&2
        cut -c 1-1200 "$work/found" >&2
        failed=1
    else
        echo "validation layer: $name: silent"
    fi
done
exit "$failed"
