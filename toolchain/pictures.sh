#!/usr/bin/env bash
# Renews the pictures of one axis under several laws: of the README under PD, PID and the impulsive law, of the law under its coasts.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/pictures.sh

Simulates sim/scenarios/can_axis.toml and can_axis_pid.toml from -0.1 m at rest, with static friction at the upper and kinetic
friction at the lower bound, and draws the position error of both, and of a PD with the impulsive law's approach gains, into
sim/report/stuck_axis.svg; and those of sim/scenarios/braked_axis.toml, and of the same file with coast = "pd", into
sim/report/coasts.svg.

Example: toolchain/pictures.sh
HELP
}

case ${1-} in
  -h | --help) usage && exit 0 ;;
  ?*) die "takes no argument; see --help" ;;
esac

require_packages run
cd -- "$root"
toolchain/run.sh >/dev/null

work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
law='kind = "static_kinetic"'
simulated() { # simulated <name> <file> [sed expression...]
  local edits=(-e 's/^position_m = -4/position_m = -0.1/' -e 's/^velocity_m_s = -4/velocity_m_s = 0/' -e "s/^kind = \"mean\"/$law/"
    -e '/^weights/d' -e '/^parts/d' -e 's/^settle_time_s.*/settle_time_s = 5\nstop_when_settled = false/' -e 's/^duration_s.*/duration_s = 5/')
  for edit in "${@:3}"; do edits+=(-e "$edit"); done
  sed "${edits[@]}" "sim/scenarios/$2" >"$work/$1.toml"
  build/release/sim/cli/breakaway simulate "$work/$1.toml" --csv "$work/$1.csv" >/dev/null || (($? == 1))
}
simulated impulsive can_axis.toml
simulated pid can_axis_pid.toml
simulated brake braked_axis.toml
simulated coast_pd braked_axis.toml 's/^coast = .*/coast = "pd"/' '/^\[uncertainty\]/,/^$/d' # which this coast is not certified with
simulated pd can_axis_pid.toml 's/^kp_N_per_m.*/kp_N_per_m = 400/' 's/^ki_N_per_ms.*/ki_N_per_ms = 0/' 's/^kd_Ns_per_m.*/kd_Ns_per_m = 32/'

drawn() { # drawn <file> <time shown in s> <title> <plot command>: the distance to the target on a logarithmic axis
  gnuplot <<PLOT
set terminal svg size 900,380 font "sans-serif,14" background "white"
set output "$1"
set datafile separator ","
set logscale y
set xrange [0:$2]
set yrange [1e-8:10]
set format y "10^{%T} m"
set xlabel "time in s"
set title "$3"
set grid ytics lc rgb "#dddddd"
set key right top
set arrow from 0,3e-6 to $2,3e-6 nohead dashtype 2 lc rgb "#888888"
set label "3 µm" at 0.015*$2,1.2e-6 textcolor rgb "#666666"
$4
PLOT
  printf '%s\n' "$1"
}
drawn sim/report/stuck_axis.svg 2 "Distance to the target, from 0.1 m, with friction between 2.5 N and 4.5 N" \
  "plot '$work/pd.csv' using 1:(abs(\$2)) with lines lw 2.5 lc rgb '#999999' title 'PD: stops short', \
     '$work/pid.csv' using 1:(abs(\$2)) with lines lw 2.5 lc rgb '#d1793a' title 'PID: hunts for ever', \
     '$work/impulsive.csv' using 1:(abs(\$2)) with lines lw 2.5 lc rgb '#1f6fb4' title 'breakaway: sticks, kicks, is there'"
drawn sim/report/coasts.svg 0.3 "Distance to the target, from 0.1 m, of one axis under either coast" \
  "plot '$work/coast_pd.csv' using 1:(abs(\$2)) with lines lw 2.5 lc rgb '#d1793a' title 'coast \"pd\"', \
     '$work/brake.csv' using 1:(abs(\$2)) with lines lw 2.5 lc rgb '#1f6fb4' title 'coast \"brake\"'"
