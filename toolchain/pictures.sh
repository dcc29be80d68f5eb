#!/usr/bin/env bash
# Renews the picture of the README: one axis under PD, PID and the impulsive law.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/pictures.sh

Simulates sim/scenarios/can_axis.toml and can_axis_pid.toml from -0.1 m at rest, with static friction at the upper and kinetic
friction at the lower bound, and draws the position error of both, and of a PD with the impulsive law's approach gains, into
sim/report/stuck_axis.svg.

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
simulated pd can_axis_pid.toml 's/^kp_N_per_m.*/kp_N_per_m = 400/' 's/^ki_N_per_ms.*/ki_N_per_ms = 0/' 's/^kd_Ns_per_m.*/kd_Ns_per_m = 32/'

gnuplot <<PLOT
set terminal svg size 900,380 font "sans-serif,14" background "white"
set output "sim/report/stuck_axis.svg"
set datafile separator ","
set logscale y
set xrange [0:2]
set yrange [1e-8:10]
set format y "10^{%T} m"
set xlabel "time in s"
set title "Distance to the target, from 0.1 m, with friction between 2.5 N and 4.5 N"
set grid ytics lc rgb "#dddddd"
set key right top
set arrow from 0,3e-6 to 2,3e-6 nohead dashtype 2 lc rgb "#888888"
set label "3 µm" at 1.9,1.2e-6 textcolor rgb "#666666"
plot "$work/pd.csv" using 1:(abs(\$2)) with lines lw 2.5 lc rgb "#999999" title "PD: stops short", \
     "$work/pid.csv" using 1:(abs(\$2)) with lines lw 2.5 lc rgb "#d1793a" title "PID: hunts for ever", \
     "$work/impulsive.csv" using 1:(abs(\$2)) with lines lw 2.5 lc rgb "#1f6fb4" title "breakaway: sticks, kicks, is there"
PLOT
printf 'sim/report/stuck_axis.svg\n'
