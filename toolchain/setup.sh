# Common part of run.sh and test.sh, which source it.
#   require_packages <use>...     installs what packages.txt lists for these uses and the machine lacks: as root, or by
#                                   sudo; with neither it names the packages and exits with 2. When nothing is missing
#                                   it neither installs nor updates anything, and needs no network.
# Exit codes of both scripts: 0 done, 1 the job itself failed, 2 the machine or the command line is at fault.

toolchain=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(dirname -- "$toolchain")

# More compilers than processors drive each other out of the caches: the four that Ninja starts on two processors take a
# quarter longer than two.
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}

die() {
  printf '%s: %s\n' "$(basename -- "$0")" "$1" >&2
  exit 2
}

missing_packages() {
  local use uses package installed
  installed=$(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n')
  while read -r use package; do
    for uses in "$@"; do
      if [[ $use == "$uses" ]] && ! grep -qxF -- "ii  $package" <<<"$installed"; then
        printf '%s\n' "$package"
      fi
    done
  done <"$toolchain/packages.txt"
}

require_packages() {
  local packages missing as_root=()
  command -v dpkg-query >/dev/null ||
    die "needs Debian 12 or a system derived from it (no dpkg-query here); toolchain/packages.txt lists what to install"
  # This is no <(...), because that needs /dev/fd, which a minimal container may lack.
  missing=$(missing_packages "$@")
  mapfile -t packages <<<"$missing"
  [[ -n $missing ]] || return 0

  if ((EUID != 0)); then
    # Without a terminal nobody can type a password, so sudo must not ask for one.
    local sudo_options=(-n)
    [[ -t 0 ]] && sudo_options=()
    command -v sudo >/dev/null && sudo "${sudo_options[@]}" true ||
      die "packages are missing, and neither root nor sudo is at hand to install them. As root:
  apt-get install ${packages[*]}
Then run this again."
    as_root=(sudo "${sudo_options[@]}")
  fi

  printf 'Installing: %s\n' "${packages[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)
  # A source that is unreachable but not needed must not stop us: whether the packages arrive is what decides.
  "${apt[@]}" update </dev/null || printf 'apt-get update reported errors; trying to install nevertheless\n' >&2
  "${apt[@]}" install -y --no-install-recommends "${packages[@]}" </dev/null ||
    die "apt-get could not install: ${packages[*]}. Check the network and the package sources, and run this again."
}
