#!/usr/bin/env bash
# A long campaign over random axes, in lumps of 500 that a second call does not repeat.
set -euo pipefail

usage() {
  cat <<'HELP'
Usage: tests/campaign/long_axis_run.sh FIRST COUNT DIRECTORY

Runs the axes of COUNT numbers from FIRST under the coast "brake", a fifth of them from far away as well, 20 of each 500
at little more than their least speed, under jitter in a pattern and from as far away as a float tells, and 60 with noise
of any size (BREAKAWAY_FAR_AXES, BREAKAWAY_SLOW_AXES, BREAKAWAY_PATTERNED_AXES, BREAKAWAY_FARTHEST_AXES,
BREAKAWAY_NOISY_AXES: so many of each 500). Writes into DIRECTORY what was said of each 500 of them, and total.txt:
how many were certified and run, and which failed. A lump that is there is left out, so that a run that was stopped goes
on. BREAKAWAY_BUILD names the build directory (build/release).

Example: nice -n 19 tests/campaign/long_axis_run.sh 0 100000 /tmp/axes
HELP
}

[[ ${1:-} != --help ]] || { usage && exit 0; }
if [[ $# -ne 3 ]]; then
  usage >&2
  exit 2
fi
first=$1 count=$2 directory=$3
test=${BREAKAWAY_BUILD:-build/release}/tests/campaign/braked_campaign_test
lump=500
mkdir -p "$directory"

for ((number = first; number < first + count; number += lump)); do
  name=$directory/axes_$number
  [[ -f $name.txt ]] && continue
  axes=$((first + count - number < lump ? first + count - number : lump))
  # Its exit status tells of failures, which the total lists.
  BREAKAWAY_FIRST_AXIS=$number BREAKAWAY_BRAKED_AXES=$axes BREAKAWAY_FAR_AXES=${BREAKAWAY_FAR_AXES:-$((axes / 5))} \
    "$test" --gtest_filter='*EveryCertifiedAxisKeepsItsPromise*' \
    > "$name.part" 2>&1 || true
  mv "$name.part" "$name.txt"
done

cat "$directory"/axes_*.txt | awk '
  / axes certified, .* runs, / { certified += $1; axes += $3; runs += $6 }
  / runs from far away, / { far += $6 }
  / runs at little more than / { slow += $6 }
  / under jitter in a pattern, / { patterned += $6 }
  / from as far away as a float tells, / { farthest += $6 }
  / with noise of any size, / { noisy += $6 }
  /^axis [0-9]+, friction/ { sub(",", "", $2); failed[$2] = 1 }
  END {
    printf "%d of %d axes certified, %d runs, %d from far away, %d slow, %d under jitter in a pattern, %d from as far away " \
      "as a float tells and %d noisy, failed:", certified, axes, runs, far, slow, patterned, farthest, noisy
    for (axis in failed) printf " %s", axis
    print ""
  }' > "$directory/total.txt"
cat "$directory/total.txt"
