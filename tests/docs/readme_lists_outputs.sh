#!/usr/bin/env bash
# readme_lists_outputs.sh PAGE RBVI: every output in the help stands in a table of the page, with
# the same definition.
set -euo pipefail
page=$1 rbvi=$2
status=0 found=0
while read -r name definition; do
  found=$((found + 1))
  row="| \`$name\` | ${definition//|/\\|} |"
  grep -qxF -- "$row" "$page" || {
    echo "not in $page: $row"
    status=1
  }
done < <("$rbvi" -help | sed -n '/^Outputs/,/^$/p' | grep -E '^  [a-z]')
((found >= 20)) || { echo "only $found outputs found in the help"; status=1; }
exit $status
