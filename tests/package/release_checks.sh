#!/bin/bash
# The recipe of a release, on a small repository of its own, whose checks and package are stand-ins.
set -euo pipefail
source=$1
scene=$(mktemp -d)
trap 'rm -rf -- "$scene"' EXIT
mkdir "$scene/toolchain"
cp -- "$source"/toolchain/{release.sh,setup.sh,packages.txt} "$scene/toolchain/"
cd -- "$scene"
export GIT_CONFIG_GLOBAL=/dev/null GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@b GIT_COMMITTER_NAME=a GIT_COMMITTER_EMAIL=a@b
printf 'project(breakaway VERSION 1.2.3 LANGUAGES CXX\n' >CMakeLists.txt
printf '# Changelog\n\n## [1.2.3] - 2026-01-02\n\n### Added\n\n- This.\n\n## [1.2.2] - 2026-01-01\n\n- That.\n' >CHANGELOG.md
printf '#!/bin/sh\nexit $(cat fails 2>/dev/null || echo 0)\n' >toolchain/test.sh
printf '#!/bin/sh\nmkdir -p out\necho package >out/breakaway_1.2.3_amd64.deb\n' >toolchain/package.sh
printf 'out/\nfails\n' >.gitignore
chmod +x toolchain/test.sh toolchain/package.sh
git init -q . && git add -A && git commit -qm one

fail() { printf 'release_checks: %s\n' "$1" >&2 && exit 1; }
# refuses <text> <argument>...: exit code 2, and one line with the text; nothing is tagged.
refuses() {
  local said code=0
  said=$(toolchain/release.sh "${@:2}" 2>&1) || code=$?
  [[ $code == 2 && $said == *"$1"* && $(wc -l <<<"$said") == 1 ]] || fail "expected '$1' and exit code 2, got $code: $said"
}

refuses 'say which version'
refuses 'MAJOR.MINOR.PATCH' 1.2
refuses 'takes one version' 1.2.3 1.2.4
refuses 'CMakeLists.txt says 1.2.3' 1.2.4
[[ $(toolchain/release.sh --check 1.2.3) == *'can be released'* ]] || fail 'does not pass what is in order'
sed -i 's/^## \[1.2.3\].*/## [Unreleased]/' CHANGELOG.md
refuses "no section '## [1.2.3] - YYYY-MM-DD'" 1.2.3
git checkout -q CHANGELOG.md
sed -i '/^### Added/d; /^- This/d' CHANGELOG.md
refuses 'is empty' 1.2.3
git checkout -q CHANGELOG.md
touch new
refuses 'not everything is committed: ?? new' 1.2.3
rm new
echo 1 >fails
! toolchain/release.sh 1.2.3 >/dev/null 2>&1 || fail 'releases what fails its checks'
[[ -z $(git tag) && ! -e out ]] || fail 'leaves a tag or files of what fails its checks'
rm fails

said=$(toolchain/release.sh 1.2.3 2>&1) || fail "does not release: $said"
(cd out && sha256sum -c --quiet SHA256SUMS) || fail 'checksums differ'
[[ $(wc -l <out/SHA256SUMS) == 3 ]] || fail 'three files make a release'
# The list is read to its end: a tar whose reader leaves early fails, or not, as the machine is busy.
[[ $(tar -tzf out/breakaway-1.2.3.tar.gz) == *'breakaway-1.2.3/CHANGELOG.md'* ]] || fail 'the sources are not whole'
[[ $(git tag -l --format='%(contents)' v1.2.3) == '### Added'*'- This.'* ]] || fail 'the tag does not say what changed'
! grep -q 'That' out/breakaway-1.2.3.md || fail 'the text has another version'
refuses 'the tag v1.2.3 is there already' 1.2.3
