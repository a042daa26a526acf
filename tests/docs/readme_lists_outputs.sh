#!/usr/bin/env bash
# readme_lists_outputs.sh README RBVI: every output in the help stands in the README's table, with the
# same definition.
set -euo pipefail
readme=$1 rbvi=$2
status=0 found=0
while read -r name definition; do
  found=$((found + 1))
  row="| \`$name\` | ${definition//|/\\|} |"
  grep -qxF -- "$row" "$readme" || {
    echo "not in $readme: $row"
    status=1
  }
done < <("$rbvi" -help | sed -n '/^Outputs/,/^$/p' | grep -E '^  [a-z]')
((found >= 20)) || { echo "only $found outputs found in the help"; status=1; }
exit $status
