# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced by scripts/validate and scripts/test: install what is missing, build. Quiet when there is
# nothing to do; honest when it cannot: prints the exact line to run and stops with 69.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
logs=$root/build/logs

# Run a step quietly; on failure show the end of its log.
step() { # step NAME COMMAND...
    local name=$1
    shift
    mkdir -p "$logs"
    if ! "$@" >"$logs/$name.log" 2>&1; then
        tail -n 30 "$logs/$name.log" >&2
        echo "$name failed; the whole log: $logs/$name.log" >&2
        return 1
    fi
}

missing_packages() {
    local package command
    while read -r package command _; do
        case $package in '' | '#'*) continue ;; esac
        if [ "$command" != - ] && command -v "$command" >/dev/null; then continue; fi
        dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
    done <"$root/scripts/packages.txt"
}

install_packages() {
    local missing line
    mapfile -t missing < <(missing_packages)
    [ ${#missing[@]} -gt 0 ] || return 0
    line="apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
    if [ "$(id -u)" -ne 0 ]; then
        printf 'These packages are missing, and only root can install them. Run:\n  sudo sh -c "%s"\n' "$line" >&2
        exit 69
    fi
    echo "installing ${#missing[@]} packages: ${missing[*]}"
    export DEBIAN_FRONTEND=noninteractive
    if ! step apt-update apt-get update ||
        ! step apt-install apt-get install -y --no-install-recommends "${missing[@]}"; then
        printf 'The packages could not be installed (offline?). When the network is there, run:\n  %s\n' "$line" >&2
        exit 69
    fi
}

# Vega for the charts, pinned by package-lock.json. Arguments: further options of npm ci.
install_node_modules() {
    local report=$root/scripts/report
    local done=$report/node_modules/.package-lock.json
    if [ -e "$done" ] && [ ! "$report/package-lock.json" -nt "$done" ]; then return 0; fi
    echo "installing the report's JavaScript"
    step npm npm ci --prefix "$report" --no-audit --no-fund "$@" && touch "$done"
}

build() { # build PRESET
    (cd "$root" && step "configure-$1" cmake --preset "$1" && step "build-$1" cmake --build --preset "$1")
}
