#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Rebuilds common/vision/vocabularies from photographs and textures of Debian packages and from the
# project's procedural reefs. The packages are unpacked into a temporary folder, not installed. On Debian 12, in
# a configured checkout:
#
#     common/vision/tools/rebuild-vocabularies.sh orb|dense [BUILD_FOLDER]     (default: build)
set -euo pipefail

which=${1:-}
[[ $which == orb || $which == dense ]] || { echo "usage: ${0##*/} orb|dense [BUILD_FOLDER]" >&2; exit 2; }
root=$(cd "$(dirname "$0")/../../.." && pwd)
build=$(realpath "${2:-$root/build}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Exact versions: other pictures would give other words.
packages=(lomiri-wallpapers-16.04=20.04.0-2 mate-backgrounds=1.26.0-1 colobot-common-textures=0.2.0-2)

cd "$work"
apt-get download "${packages[@]}" >&2
for package in *.deb; do dpkg-deb -x "$package" unpacked; done

# Photographs of landscapes, plants and ground; textures of terrain. Drawings, logos and sprites stay out.
mkdir photographs textures
cp unpacked/usr/share/backgrounds/*.jpg photographs/
cp unpacked/usr/share/backgrounds/mate/nature/*.jpg unpacked/usr/share/backgrounds/mate/abstract/Elephants.jpg \
   photographs/
terrain=unpacked/usr/share/games/colobot/textures
cp "$terrain"/{chili,desert,dirty,green,lava,mars,mix,water}*.png "$terrain"/{moon103,roca2,rocb2,terra002}.png \
   textures/

reefs=(reef:sparse reef:varied reef:tuning)
vocabularies=$root/common/vision/vocabularies
if [[ $which == orb ]]; then
  cmake --build "$build" --target shoal_build_vocabulary >&2
  "$build/bin/shoal_build_vocabulary" "$vocabularies/orb_5000.voc" photographs textures "${reefs[@]}"
else
  cmake --build "$build" --target shoal_build_dense_vocabulary >&2
  "$build/bin/shoal_build_dense_vocabulary" "$vocabularies/dense.voc" photographs one:textures "${reefs[@]}"
fi
