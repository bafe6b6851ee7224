# Sourced: a new Python environment in $work/env, which is deleted at the end, and the command "${pip[@]}" that installs packages into it.
# Needs Python 3.10 or later with venv, and PyPI; the caller's `skip` says so and ends where one of them is missing.
python=$(command -v python3) || skip "no Python"
"$python" -c 'import sys, venv; sys.exit(sys.version_info < (3, 10))' 2> /dev/null || skip "no Python 3.10 or later"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_CACHE_DIR=${PIP_CACHE_DIR:-$work/pip} PIP_DISABLE_PIP_VERSION_CHECK=1 PYTHONDONTWRITEBYTECODE=1
export UV_CACHE_DIR=${UV_CACHE_DIR:-$work/uv}
"$python" -m venv "$work/env" > "$work/log" 2>&1 || skip "no environment ($(tail -n 1 "$work/log"))"
# uv installs in a tenth of pip's time.
pip=("$work/env/bin/pip" install --quiet)
"${pip[@]}" uv 2> /dev/null || skip "no PyPI"
pip=("$work/env/bin/uv" pip install --quiet --python "$work/env/bin/python")
