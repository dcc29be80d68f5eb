#!/bin/sh
# On a bare Debian, as its user would: the package in /root, then an axis, its certificate and its report. Takes nothing that
# the package does not bring or depend on.
set -eu
began=$(date +%s)
export DEBIAN_FRONTEND=noninteractive
apt-get -q update >/dev/null
apt-get -q install -y -o APT::Install-Recommends=true /root/breakaway_*.deb >/root/install.log 2>&1 || { cat /root/install.log; exit 1; }
cd /tmp
breakaway new --mass 1 --friction-lower 2.5 --friction-upper 4.5 --encoder 1e-6 --rate 1000 --force 50 --move 0.1 -o axis.toml
breakaway design axis.toml --header node.hpp
breakaway simulate axis.toml --report axis.html
breakaway-node --version
test -s axis.html
test -s node.hpp
test -s /usr/share/man/man1/breakaway.1 || test -s /usr/share/man/man1/breakaway.1.gz
test -s /usr/share/bash-completion/completions/breakaway
grep -q 'ExecStart=/usr/bin/breakaway-node ' /usr/lib/systemd/system/breakaway-node.service
ldconfig -p | grep libbreakaway_law.so >/dev/null
printf 'from the package to a settled axis with its report in %d s\n' $(($(date +%s) - began))
apt-get -q install -y python3-numpy >>/root/install.log 2>&1 || { cat /root/install.log; exit 1; }
python3 -c '
import breakaway
print("import breakaway: settled at %.3f s" % breakaway.simulate("axis.toml").figures["settling_time_s"])'
