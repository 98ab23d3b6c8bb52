#!/usr/bin/env bash
# Installs the Debian 12 packages that Anatomesh is built and shown with; those already there are left alone.
# Run as root, or as a user with sudo. Arguments are further packages.
set -euo pipefail

packages=(
  # to build
  g++ make cmake ninja-build
  libinsighttoolkit5-dev libvtk9-dev libtbb-dev libeigen3-dev libnanoflann-dev
  libcli11-dev nlohmann-json3-dev libfmt-dev libhdf5-dev libpugixml-dev zlib1g-dev
  python3-dev pybind11-dev
  # to test
  libgtest-dev clang-format libbenchmark-dev valgrind pkg-config dpkg-dev file
  # programs that are not ours, to read what we write
  calculix-ccx gmsh tetgen python3-dolfinx python3-h5py python3-meshio python3-nibabel
  # for the demo: the images, and pictures without a display
  mricron-data python3 python3-vtk9 python3-numpy xvfb xauth libgl1-mesa-dri
  "$@"
)

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
  [[ "$status" == "install ok installed" ]] || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "packages: all ${#packages[@]} are installed"
  exit 0
fi

as_root=()
if [[ $EUID -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "packages: missing ${missing[*]}; run this as root, or install sudo" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "packages: installing ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
