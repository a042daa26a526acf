#!/usr/bin/env bash
# options_page.sh PAGE RBVI: the page is what `rbvi -help -markdown` prints.
set -euo pipefail
diff -u "$1" <("$2" -help -markdown) || {
  echo "make it anew: rbvi -help -markdown > cases/OPTIONS.md"
  exit 1
}
