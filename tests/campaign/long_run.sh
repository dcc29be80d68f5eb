#!/usr/bin/env bash
# A long campaign over random machines, in lumps of 1,000 that a second call does not repeat.
set -euo pipefail

usage() {
  cat <<'HELP'
Usage: tests/campaign/long_run.sh FIRST COUNT DIRECTORY [METHOD]

Runs the machines of COUNT numbers from FIRST by METHOD (event-driven, adaptive, "time stepping"; without it by all three)
and writes into DIRECTORY a table for each 1,000 of them, what was said of each defect, the scenes of the defects, and
total.md, which is the sum of all tables there. A lump whose table is there is left out, so that a run that was stopped
goes on, and several processes can share DIRECTORY when each has numbers of its own. With a COUNT of 0 it only adds.
BREAKAWAY_BUILD names the build directory (build/release).

Example: tests/campaign/long_run.sh 0 100000 /tmp/campaign event-driven
HELP
}

[[ ${1:-} != --help ]] || { usage && exit 0; }
if [[ $# -lt 3 || $# -gt 4 ]]; then
  usage >&2
  exit 2
fi
first=$1 count=$2 directory=$3 method=${4:-}
test=${BREAKAWAY_BUILD:-build/release}/tests/campaign/machine_campaign_test
lump=1000
mkdir -p "$directory"

for ((number = first; number < first + count; number += lump)); do
  name=$directory/${method:-all}_$number
  [[ -f $name.md ]] && continue
  systems=$((first + count - number < lump ? first + count - number : lump))
  # Its exit status tells of defects, which the table counts.
  BREAKAWAY_FIRST_SYSTEM=$number BREAKAWAY_SYSTEMS=$systems BREAKAWAY_METHOD=$method BREAKAWAY_CPU_S=10 \
    BREAKAWAY_RESULTS=$name.part BREAKAWAY_FAILURES=$directory/failures.toml "$test" 2>/dev/null |
    grep '^machine ' >> "$directory/defects.txt" || true
  mv "$name.part" "$name.md"
  echo "$(date +%T) $number to $((number + systems - 1)) done"
done

# Rows of one family and method are added; the last column is the greatest.
sum() {
  awk -F' *[|] *' '
    FNR <= 2 { if (NR <= 2) print; next }
    {
      key = $2 "|" $3
      if (!(key in worst)) { order[++rows] = key; worst[key] = 0 }
      for (i = 4; i < NF - 1; ++i) total[key, i] += $i
      if ($(NF - 1) + 0 > worst[key]) worst[key] = $(NF - 1) + 0
      last = NF - 1
    }
    END {
      for (r = 1; r <= rows; ++r) {
        split(order[r], names, "|")
        printf "| %s | %s |", names[1], names[2]
        for (i = 4; i < last; ++i) printf " %d |", total[order[r], i]
        printf " %.2g |\n", worst[order[r]]
      }
    }' "$@"
}
sum "$directory"/*_[0-9]*.md > "$directory/total.md"
