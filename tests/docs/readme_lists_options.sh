#!/usr/bin/env bash
# readme_lists_options.sh PAGE COMMAND...: every option in the help of each command stands in the
# page, with its dash, as code.
set -euo pipefail
page=$1
shift
status=0 found=0
for command in "$@"; do
  for option in $("$command" --help | grep -oE '^ +--?[a-z][a-z0-9_]*' | tr -d ' '); do
    found=$((found + 1))
    grep -qE -- "\`$option[\` =]" "$page" || {
      echo "$option of $(basename "$command") is not in $page"
      status=1
    }
  done
done
((found >= 30)) || { echo "only $found options found in the help"; status=1; }
exit $status
