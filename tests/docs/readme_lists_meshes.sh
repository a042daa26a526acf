#!/usr/bin/env bash
# readme_lists_meshes.sh CASE RBVI: the mesh that -help describes for the case in that folder stands in
# its README, line by line.
set -euo pipefail
case=$1 rbvi=$2
status=0 found=0
while read -r line; do
  found=$((found + 1))
  grep -qF -- "$line" "$case/README.md" || {
    echo "not in $case/README.md: $line"
    status=1
  }
done < <("$rbvi" -help -case "$case" | grep '^    ')
((found >= 3)) || { echo "only $found lines found in the help"; status=1; }
exit $status
