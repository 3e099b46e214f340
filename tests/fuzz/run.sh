#!/usr/bin/env bash
# Runs every fuzzer of build/asan-ubsan, two at a time, and says what each did:
#
#   tests/fuzz/run.sh SECONDS
#
# Starts from samples/ and tests/cases/ and keeps what it finds new in build/fuzz/found/. Ends with
# 1 when a promise was broken, a program took more than 30 s (less than 10 without the sanitizers) or
# memory was lost; the program that did it lies in build/fuzz/broken/.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:?"seconds for each fuzzer"}

declare -A longest=([parse]=1000 [interpret]=2000 [curves]=1000 [smooth]=3000) # bytes of a program
logs=build/fuzz/logs
mkdir -p "$logs" build/fuzz/broken

run() { # name
  local found=build/fuzz/found/$1
  mkdir -p "$found"
  "build/asan-ubsan/tests/$1_fuzz" -max_len="${longest[$1]}" -max_total_time="$seconds" -timeout=30 \
    -print_final_stats=1 -artifact_prefix="build/fuzz/broken/$1-" \
    "$found" samples/*/ tests/cases/*/ >"$logs/$1" 2>&1
}

failed=0
told() { # name, exit code
  local programs edges
  programs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$logs/$1")
  edges=$(grep -o 'cov: [0-9]*' "$logs/$1" | tail -n 1)
  echo "$1: ${programs:-?} programs, ${edges:-cov: ?} edges, exit code $2"
  if [[ $2 -ne 0 ]]; then
    failed=1
    tail -n 30 "$logs/$1"
  fi
}

for pair in "parse smooth" "interpret curves"; do
  read -r one other <<<"$pair"
  run "$one" &
  first=$!
  run "$other" &
  second=$!
  wait "$first"
  told "$one" $?
  wait "$second"
  told "$other" $?
done
exit "$failed"
