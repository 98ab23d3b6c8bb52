#!/usr/bin/env bash
# Checks the format of every C++ file with clang-format 14; --fix rewrites the files instead.
set -euo pipefail
cd "$(dirname "$0")/.."

formatter=$(command -v clang-format-14 || command -v clang-format || true)
if [[ -z "$formatter" ]]; then
  echo "style: clang-format is not installed (tools/install_packages.sh installs it)" >&2
  exit 1
fi

folders=()
for folder in include src apps tests bindings plugins benchmarks examples; do
  [[ -d "$folder" ]] && folders+=("$folder")
done
mapfile -t files < <(find "${folders[@]}" -name '*.h' -o -name '*.cpp' | sort)

if [[ "${1:-}" == --fix ]]; then
  "$formatter" -i "${files[@]}"
  echo "style: ${#files[@]} files formatted"
elif "$formatter" --dry-run -Werror "${files[@]}"; then
  echo "style: ${#files[@]} files are well formatted"
else
  echo "style: run tools/check_style.sh --fix" >&2
  exit 1
fi
