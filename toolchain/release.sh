#!/usr/bin/env bash
# Makes a release of what is committed: everything is checked first, and the tag is set last.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

usage() {
  cat <<'HELP'
Usage: toolchain/release.sh [--check] VERSION

Makes a release of the commit that is checked out, in this order, stopping at the first that fails:

  1. the version is that of CMakeLists.txt and has a dated section in CHANGELOG.md, nothing is uncommitted, and there is no
     such tag yet
  2. toolchain/test.sh --long passes
  3. out/breakaway-VERSION.tar.gz, the sources of the commit; out/breakaway_VERSION_ARCHITECTURE.deb, tried on a bare Debian
     (as root); out/breakaway-VERSION.md, the section of the changelog; out/SHA256SUMS over them
  4. the annotated tag vVERSION

Nothing is sent anywhere: the last lines say what to push and to upload.

  --check   step 1 only

Example: toolchain/release.sh 0.2.0
HELP
}

check_only=false
while (($# > 0)); do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --check) check_only=true ;;
    -*) die "unknown option '$1'; see --help" ;;
    *)
      [[ -z ${version-} ]] || die "takes one version, got '$version' and '$1'; see --help"
      version=$1
      ;;
  esac
  shift
done
[[ -n ${version-} ]] || die "say which version, as in toolchain/release.sh 0.2.0; see --help"
[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+$ ]] || die "'$version' is no version: give MAJOR.MINOR.PATCH"
tag=v$version
cd -- "$root"

# What users read of this version: the section of the changelog, without its heading.
section() {
  awk -v heading="## [$version] - " 'index($0, "## ") == 1 { inside = index($0, heading) == 1; next } inside' CHANGELOG.md
}

check() {
  local stated unsaved
  stated=$(sed -n 's/^project(breakaway VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
  [[ $stated == "$version" ]] || die "CMakeLists.txt says $stated: write project(breakaway VERSION $version, commit, and run this again"
  grep -Eq "^## \[${version//./\\.}\] - [0-9]{4}-[0-9]{2}-[0-9]{2}$" CHANGELOG.md ||
    die "CHANGELOG.md has no section '## [$version] - YYYY-MM-DD': rename [Unreleased] to it, commit, and run this again"
  # Not grep -q, which leaves awk without a reader: a long section would be called empty.
  [[ $(section) == *[![:space:]]* ]] || die "the section of $version in CHANGELOG.md is empty: say what changed"
  unsaved=$(git status --porcelain)
  [[ -z $unsaved ]] || die "not everything is committed: ${unsaved//$'\n'/, }; commit or remove that"
  ! git rev-parse -q --verify "refs/tags/$tag" >/dev/null || die "the tag $tag is there already: raise the version"
}

check
printf '%s can be released: version, changelog and tree agree\n' "$version"
$check_only && exit 0

toolchain/test.sh --long
try=()
((EUID != 0)) || try=(--try)
toolchain/package.sh "${try[@]}"
git archive --format=tar.gz --prefix="breakaway-$version/" -o "out/breakaway-$version.tar.gz" HEAD
section >"out/breakaway-$version.md"
(cd -- out && sha256sum -- breakaway-"$version".tar.gz breakaway_"$version"_*.deb breakaway-"$version".md | tee SHA256SUMS)
check # that nothing was changed meanwhile
git tag -a "$tag" --cleanup=whitespace -F "out/breakaway-$version.md"
printf '\n%s is tagged. Next:\n  git push origin %s\n  upload out/breakaway-%s.tar.gz, out/breakaway_%s_*.deb and out/SHA256SUMS, with out/breakaway-%s.md as the text\n' \
  "$version" "$tag" "$version" "$version" "$version"
