#!/bin/sh
# Makes .venv and installs create-herd into it, with the versions of constraints.txt.
set -eu
cd "$(dirname "$0")/.."
python="${PYTHON:-python3}"

say() { printf 'create-herd: %s\n' "$1"; }
stop() { say "$1" >&2; exit 1; }

command -v "$python" >/dev/null 2>&1 || stop "$python was not found; expected Python 3.11 or newer"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    stop "$("$python" --version) is too old; expected Python 3.11 or newer"

if ! "$python" -c 'import ensurepip, venv' >/dev/null 2>&1; then
    advice="the venv module is missing; install it with: apt-get install python3-venv"
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
        say "installing python3-venv"
        { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y python3-venv; } >/dev/null 2>&1 ||
            stop "$advice"
    else
        stop "$advice"
    fi
fi

if [ ! -x .venv/bin/python ] || ! .venv/bin/python -m pip --version >/dev/null 2>&1; then
    say "making .venv"
    "$python" -m venv --clear .venv
fi
say "installing (a minute on a new machine)"
.venv/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev]'
# Cameras' images are rendered with OpenGL; all else works without it.
if ! .venv/bin/python -m sensing.camera.opengl >/dev/null 2>&1; then
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
        say "installing libosmesa6, which renders the cameras' images"
        { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y libosmesa6; } >/dev/null 2>&1 || true
    fi
    .venv/bin/python -m sensing.camera.opengl >/dev/null 2>&1 ||
        say "experiments with cameras will not run: OpenGL is missing; install it with: apt-get install libosmesa6"
fi
touch .venv/ready
