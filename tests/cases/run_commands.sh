#!/usr/bin/env bash
# run_commands.sh BIN SCRATCH CASE_FILE MU [-option value ...]: every command of both programs on a
# few parameters of one case. Ends at the first that fails.
set -euo pipefail
bin=$1 scratch=$2 case_file=$3 mu=$4
shift 4
run=$scratch/run
rm -rf "$scratch"
mkdir -p "$scratch"
options=(-case "$case_file" -valid random:3:1 "$@")

mpirun -n 2 "$bin/rbvi" offline "${options[@]}" -plan
mpirun -n 2 "$bin/rbvi" offline "${options[@]}" -out "$run"
mpirun -n 2 "$bin/rbvi" offline "${options[@]}" -out "$run" # all samples are there
mpirun -n 2 "$bin/rbvi" verify "${options[@]}" -out "$run"
"$bin/rbvi" bench "${options[@]}" -out "$run"
mpirun -n 2 "$bin/rbvi" solve "${options[@]}" -mu "$mu" -vtu "$scratch/hf.vtu" -csv "$scratch/hf.csv"
"$bin/rbvi" list
"$bin/rbvi" inspect "$run/model.h5"
"$bin/rbvi-online" "$run/model.h5"
"$bin/rbvi-online" "$run/model.h5" --mu "$mu" --full --vtu "$run/u.vtu"
"$bin/rbvi-online" "$run/model.h5" --mu "$mu" --decorrelated || test $? = 1 # may have no answer
"$bin/rbvi-online" "$run/model.h5" --queries random:20:1 --out "$scratch/answers.csv"
"$bin/rbvi-online" "$run/model.h5" --queries "$scratch/answers.csv" --full >"$scratch/again.csv"
