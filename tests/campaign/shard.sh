#!/usr/bin/env bash
# Part of a long campaign, for one of many machines; and what all parts say together.
set -euo pipefail

usage() {
  cat <<'HELP'
Usage: tests/campaign/shard.sh TEST NUMBERS FOLDER --shard i/n
       tests/campaign/shard.sh TEST NUMBERS FOLDER --merge n

Runs part i of n (i from 1 to n) of a campaign of so many numbers and writes what it says to FOLDER, which all parts share. --merge runs
nothing: it says whether all n parts are there, whole and passed, and names what failed. TEST is the name of a test of
this folder, or the path of its program; BREAKAWAY_BUILD names the build directory (build/release). What else a test takes from the
environment (README.md) it takes here, too. fault_campaign_test, whose table is one, takes no parts.

Example: seq 8 | parallel tests/campaign/shard.sh braked_campaign_test 10000 /tmp/axes --shard {}/8
         tests/campaign/shard.sh braked_campaign_test 10000 /tmp/axes --merge 8
Exit codes: 0 passed, 1 failed or not whole, 2 the command line is at fault.
HELP
}

refuse() {
  printf 'shard.sh: %s; see --help\n' "$1" >&2
  exit 2
}

[[ ${1-} != --help && ${1-} != -h ]] || { usage && exit 0; }
(($# == 5)) || refuse 'give a test, how many numbers, a folder, and --shard i/n or --merge n'
test=$1 numbers=$2 folder=$3 what=$4 part=$5
[[ $test == */* ]] || test=${BREAKAWAY_BUILD:-build/release}/tests/campaign/$test
name=$(basename -- "$test")
[[ $numbers =~ ^[1-9][0-9]{0,8}$ ]] || refuse "$numbers is not a number of numbers"

# The variables that name the first number, and how many there are.
case $name in
  accuracy_campaign_test) first=(SYSTEM AXIS) counts=(SYSTEMS AXES) ;;
  adversary_campaign_test) first=(FIGHT) counts=(FIGHTS) ;;
  attraction_campaign_test | machine_campaign_test | wild_attraction_test) first=(SYSTEM) counts=(SYSTEMS) ;;
  braked_campaign_test) first=(AXIS) counts=(BRAKED_AXES FAR_AXES SLOW_AXES RETARGETED_AXES BRAKED_MOVES TOLD_WRONG) ;;
  coupled_campaign_test) first=(MACHINE) counts=(KICKS MACHINES) ;;
  fine_campaign_test) first=(AXIS) counts=(FINE_AXES) ;;
  identify_campaign_test) first=(AXIS) counts=(UNKNOWN_AXES) ;;
  presliding_campaign_test) first=(AXIS) counts=(BENDING_AXES) ;;
  sampled_campaign_test) first=(AXIS) counts=(SAMPLED_AXES SLOW_AXES) ;;
  spring_load_campaign_test) first=('') counts=(SPRUNG_AXES) ;;
  tune_campaign_test) first=(AXIS) counts=(TUNED_AXES) ;;
  wild_twins_test) first=(SYSTEM) counts=(SYSTEMS DESIGNS) ;;
  work_campaign_test) first=('') counts=(WORK_AXES FAR_AXES SLOW_AXES WORK_LOAD_AXES FAR_LOAD_AXES SLOW_LOAD_AXES) ;;
  *) refuse "$name is no campaign that takes parts" ;;
esac

file_of() { printf '%s/%s_%d_of_%d_of_%d.txt' "$folder" "$name" "$1" "$2" "$numbers"; }

run_part() {
  local i=$1 n=$2 begin end variable whole
  ((n <= numbers)) || refuse "$numbers numbers make no $n parts"
  begin=$(((i - 1) * numbers / n)) end=$((i * numbers / n))
  [[ -x $test ]] || refuse "$test is not there: build it, or name the build by BREAKAWAY_BUILD"
  for variable in "${first[@]}"; do export "BREAKAWAY_FIRST${variable:+_$variable}=$begin"; done
  for variable in "${counts[@]}"; do export "BREAKAWAY_$variable=$((end - begin))"; done
  mkdir -p -- "$folder"
  whole=$(file_of "$i" "$n")
  local verdict=passed
  printf 'numbers %d to %d\n' "$begin" "$((end - 1))" >"$whole.part"
  "$test" >>"$whole.part" 2>&1 || verdict=failed
  printf 'this part %s\n' "$verdict" >>"$whole.part"
  mv -- "$whole.part" "$whole"
  printf '%s %d/%d, numbers %d to %d: %s\n' "$name" "$i" "$n" "$begin" "$((end - 1))" "$verdict"
  [[ $verdict == passed ]]
}

merge() {
  local n=$1 i file missing='' failed=0
  for ((i = 1; i <= n; ++i)); do
    file=$(file_of "$i" "$n")
    if [[ ! -f $file ]]; then
      missing+=" $i/$n"
    elif [[ $(tail -n 1 -- "$file") != 'this part passed' ]]; then
      failed=$((failed + 1))
      printf '%s failed:\n' "$file"
      sed -n '/^\[  FAILED  \].*[^:]$/p' -- "$file" | sort -u
    fi
  done
  [[ -z $missing ]] || { printf 'shard.sh: these parts are not there, or not over:%s\n' "$missing" >&2; return 1; }
  printf '%s, %d numbers in %d parts: %s\n' "$name" "$numbers" "$n" "$(((failed)) && printf '%d failed' "$failed" || printf passed)"
  ((failed == 0))
}

case $what in
  --shard)
    [[ $part =~ ^([1-9][0-9]{0,5})/([1-9][0-9]{0,5})$ ]] && ((BASH_REMATCH[1] <= BASH_REMATCH[2])) ||
      refuse "--shard $part is not i/n with i from 1 to n"
    run_part "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}"
    ;;
  --merge)
    [[ $part =~ ^[1-9][0-9]{0,5}$ ]] || refuse "--merge $part is not a number of parts"
    merge "$part"
    ;;
  *) refuse "$what is neither --shard nor --merge" ;;
esac
