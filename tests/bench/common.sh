# Shared by the benchmarks of the scenes; to be sourced from bash with `bin`, the folder of the
# programs, set. Logs and run directories live in $work.
# shellcheck source=mpi-scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../mpi-scripts/common.sh"

# shellcheck disable=SC2154
if [[ -n ${RBVI_BENCH_WORK:-} ]]; then
  work=$RBVI_BENCH_WORK # of tests/bench/all, which keeps it and has seen that the tree is clean
  commit=$(git rev-parse --short HEAD)
else
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  commit=$(git describe --always --dirty 2>/dev/null || echo unknown)
fi
repeats=5

# logged NAME COMMAND...: what it prints goes to $work/NAME.log, unless an earlier run was there; the
# run directory NAME of one that was cut short is made anew, as its times would be of two runs.
logged() {
  local log=$work/$1.log
  [[ -e $log ]] && return
  [[ -e $log.part ]] && rm -rf "${work:?}/$1"
  "${@:2}" >"$log.part"
  mv "$log.part" "$log"
}
# seeded NAME FROM: a run directory with the samples of another one.
seeded() {
  [[ -e $work/$1.log ]] && return
  rm -rf "${work:?}/$1"
  mkdir "$work/$1"
  cp -r "$work/$2/samples" "$work/$1/samples"
}

median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
best() { sort -g | head -n 1; }
times() { # stage, logs
  awk -v stage="  $1 " 'index($0, stage) == 1 { split(substr($0, length(stage)), word, " ")
    if (word[1] ~ /^[0-9]+[.][0-9][0-9][0-9]$/) print word[1] }' "${@:2}"
}
stage() { times "$@" | median; }
made_offline() { sed -n 's/^  supremizers made offline//p' "$work/$1.log"; } # log of verify: its errors
value() { sed -n "s/.*$1.*/\1/p" "$work/$2.log" | head -n 1; } # expression with one group, log
column() { # file, row, column number
  awk -v row="$2" -v column="$3" 'BEGIN { FS = "\",\"" }
    index($1, row) { value = $column } END { print value }' "$1"
}

: >"$work/targets"
target() { # what, target, measured, condition on x (empty: none)
  local verdict=""
  if [[ -z $3 ]]; then
    verdict="NOT MEASURED"
  elif [[ -n $4 ]]; then
    verdict=$(awk -v x="$3" "BEGIN { print ($4) ? \"met\" : \"NOT MET\" }")
  fi
  printf '%s;%s;%s;%s\n' "$1" "$2" "$3" "$verdict" >>"$work/targets"
}

machine() { # command: one line for the head of a table of results
  printf 'Command `%s`, commit %s, %s cores (%s), load %s at the end' "$1" "$commit" "$cores" \
    "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" "$(cut -d ' ' -f 1 /proc/loadavg)"
}
targets_table() {
  printf '\n| what | target | measured | |\n|---|---|---|---|\n'
  sed 's/;/ | /g; s/^/| /; s/$/ |/' "$work/targets"
}
targets_csv() {
  echo "what,target,measured,verdict"
  sed 's/;/","/g; s/^/"/; s/$/"/' "$work/targets"
}
report() { # title, run directory, log of verify
  printf '\n## Run time against error, %s\n\n' "$1"
  sed '/^Tables:/d; /^.*samples per group/d' "$2/bench/table.md"
  printf '\n```\n%s\n```\n' "$(sed -n '/^Inf-sup/,/fewest\|all [0-9]* supremizers/p' "$work/$3.log" | sed '/^wrote/d')"
}
finish() { # results: path without its ending
  say "written: $1.md, $1.csv"
  grep -E 'NOT (MET|MEASURED)' "$work/targets" || say "all targets met"
}

variant() { # case, variant: prints a file of options that choose it
  local file="$work/${1//\//_}_$2.yaml"
  printf 'case: %s/case.yaml\n' "$PWD/$1" >"$file"
  [[ $2 == case ]] || printf 'variant: %s\n' "$2" >>"$file"
  echo "$file"
}
