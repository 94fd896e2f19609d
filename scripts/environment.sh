# Sourced by demo, test and check: makes the repository's own Python environment.
#
#   make_environment [EXTRA]    .venv with this package, editable, and one extra
#
# An environment that is there and works is kept. Afterwards $bin holds its commands.

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
environment=$repository/.venv
bin=$environment/bin
uv=$(command -v uv || true)

say() { printf '==> %s\n' "$*" >&2; }

fail() {
    printf 'error: %s\n' "$*" >&2
    exit 1
}

# Whether a command is a Python that is new enough
new_enough() {
    "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1
}

find_python() {
    local name
    for name in python3.13 python3.12 python3.11 python3; do
        if new_enough "$name"; then
            command -v "$name"
            return
        fi
    done
    return 1
}

# Install Debian packages as root, or tell how
install_debian() {
    local command="apt-get update && apt-get install -y --no-install-recommends $*"
    if ! command -v apt-get >/dev/null || [ "$(id -u)" -ne 0 ]; then
        fail "$* missing; install it (Debian: sudo sh -c '$command') and start again"
    fi
    say "installing $*"
    DEBIAN_FRONTEND=noninteractive sh -c "$command" >&2 </dev/null
}

# Make .venv with venv and pip
make_with_venv() {
    local python version
    if ! python=$(find_python); then
        install_debian python3 python3-venv
        python=$(find_python) || fail "Python 3.11 or newer expected; none was found"
    fi

    # Debian keeps ensurepip, which venv needs, in a package of its own
    if ! "$python" -c 'import ensurepip, venv' >/dev/null 2>&1; then
        version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
        install_debian "python$version-venv"
    fi
    say "making .venv with $("$python" --version)"
    "$python" -m venv --clear "$environment"
}

# Whether .venv runs, and packages can be installed in it
healthy() {
    new_enough "$bin/python" && { [ -n "$uv" ] || "$bin/python" -m pip --version; } \
        >/dev/null 2>&1
}

make_environment() {
    local extra=${1:-} stamp wanted

    if healthy; then
        say "using .venv, $("$bin/python" --version)"
    else
        rm -rf "$environment"
        if [ -n "$uv" ]; then
            say "making .venv with uv"
            "$uv" venv --quiet --python '>=3.11,<3.14' "$environment"
        else
            make_with_venv
        fi
    fi

    # Install unless it was done here before, for the same pyproject.toml
    stamp=$environment/.installed${extra:+-$extra}
    wanted="$repository $(cksum <"$repository/pyproject.toml")"
    if [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$wanted" ]; then
        return
    fi
    say "installing clerestory${extra:+ with extra \"$extra\"}; the first time takes minutes"
    if [ -n "$uv" ]; then
        "$uv" pip install --quiet --python "$bin/python" -e "$repository${extra:+[$extra]}"
    else
        "$bin/python" -m pip install --quiet --disable-pip-version-check \
            -e "$repository${extra:+[$extra]}"
    fi
    echo "$wanted" >"$stamp"
}
