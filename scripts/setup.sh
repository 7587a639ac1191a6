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

# What is missing of the packages of a need: build, package or validate (and that), test (and all
# three), night (all).
missing_packages() {
    local package command need needs=" build $1 "
    if [ "$1" = test ] || [ "$1" = night ]; then needs+="package validate test "; fi
    while read -r package command need _; do
        case $package in '' | '#'*) continue ;; esac
        if [[ $needs != *" $need "* ]]; then continue; fi
        case $command in
        -) ;;
        /*) if [ -e "$command" ]; then continue; fi ;;
        *) if command -v "$command" >/dev/null; then continue; fi ;;
        esac
        if [[ $package == *\? ]]; then
            package=${package%\?}
            if ! apt-cache show "$package" >/dev/null 2>&1; then continue; fi
        fi
        dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
    done <"$root/scripts/packages.txt"
}

install_packages() { # install_packages build|package|validate|test|night
    local missing line
    mapfile -t missing < <(missing_packages "$1")
    [ ${#missing[@]} -gt 0 ] || return 0
    if [ "$(id -u)" -ne 0 ]; then
        line="apt-get update && apt-get install -y --no-install-recommends $(missing_packages "${2:-$1}" | tr '\n' ' ')"
        printf 'These packages are missing, and only root can install them. Run:\n  sudo sh -c "%s"\n' "$line" >&2
        exit 69
    fi
    line="apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
    echo "installing ${#missing[@]} packages: ${missing[*]}"
    export DEBIAN_FRONTEND=noninteractive
    if ! { [ -n "${lists_are_fresh-}" ] || step apt-update apt-get update; } ||
        ! mapfile -t missing < <(missing_packages "$1") || # by lists of today
        ! step apt-install apt-get install -y --no-install-recommends "${missing[@]}"; then
        printf 'The packages could not be installed (offline?). When the network is there, run:\n  %s\n' "$line" >&2
        exit 69
    fi
    lists_are_fresh=yes
}

# The report's JavaScript, pinned by package-lock.json: for validate Vega alone, for test the browser
# driver too. A file beside the modules says for which of them they were installed.
install_node_modules() { # install_node_modules validate|test
    local report=$root/scripts/report
    local done=$report/node_modules/.installed-for
    if [ -e "$done" ] && [ ! "$report/package-lock.json" -nt "$done" ] && grep -qxE "$1|test" "$done"; then return 0; fi
    echo "installing the report's JavaScript"
    local omit=()
    if [ "$1" = validate ]; then omit=(--omit=dev); fi
    step npm npm ci --prefix "$report" --no-audit --no-fund "${omit[@]}" && echo "$1" >"$done"
}

# What `cmake --install` and cpack install.
# shellcheck disable=SC2034
installed_targets=(manual neph_metrics_shared) # with neph and the programs beside it

build() { # build PRESET [TARGET...]; a target needs nothing of what tests need
    local testing=ON target=()
    if [ $# -gt 1 ]; then testing=OFF target=(--target "${@:2}"); fi
    echo "building ($1)"
    (cd "$root" && step "configure-$1" cmake --preset "$1" -DBUILD_TESTING=$testing &&
        step "build-$1" cmake --build --preset "$1" "${target[@]}")
}
