#!/usr/bin/env bash
# printed_page.sh PAGE COMMAND...: the page is what the command prints.
set -euo pipefail
diff -u "$1" <("${@:2}") || {
  echo "make it anew: ${*:2} > $1"
  exit 1
}
