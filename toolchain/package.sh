#!/usr/bin/env bash
# Builds the Debian package, and tries it where nothing else is.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/package.sh [--try]

Installs what the build needs and the machine lacks (Debian packages, as root or by sudo), builds everything that is installed
and writes out/breakaway_VERSION_ARCHITECTURE.deb with its checksum beside it.

  --try   also installs it on a bare Debian 12, made for it and thrown away (as root; needs the network): from there to a
          settled axis with its report

Example: toolchain/package.sh && sudo apt-get install ./out/breakaway_*.deb
HELP
}

try=false
(($# <= 1)) || die "takes one option at most, got $#; see --help"
case ${1-} in
  -h | --help) usage && exit 0 ;;
  --try) try=true ;;
  ?*) die "unknown option '$1'; see --help" ;;
esac

require_packages run package
cd -- "$root"

options=()
[[ -e build/release/CMakeCache.txt ]] || options=(-DBREAKAWAY_BUILD_TESTS=OFF)
cmake --preset release "${options[@]}" --log-level=WARNING
cmake --build --preset release --target package
mkdir -p out
rm -f -- out/breakaway_*.deb
mv -- build/release/breakaway_*.deb out/
package=$(cd -- out && echo breakaway_*.deb)
(cd -- out && sha256sum -- "$package" | tee "$package.sha256")
$try || exit 0

((EUID == 0)) || die "a bare Debian is made by root; run this as root"
in_bare_debian() {
  # The chroot is of mmdebstrap's making, mounts and all; nothing of this machine is in it.
  mmdebstrap --quiet --variant=apt --mode=root --customize-hook="copy-in 'out/$package' /root" \
    --customize-hook='copy-in tests/package/bare_debian.sh /root' \
    --customize-hook='chroot "$1" sh /root/bare_debian.sh' bookworm /dev/null
}
in_bare_debian
