#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Do other compilers, flags and processors cluster alike? Builds the matching room and print_clusterings in a
# folder of its own, once for each, and compares what they print. Compilers that are not installed are named
# and left out.
#
#     tests/matching/compare_builds.sh EIGEN_INCLUDE_DIR [FOLDER OF WORKED CASES]
set -euo pipefail
eigen=$(realpath "$1")
cases=${2:+$(realpath "$2")}
top=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/shoal"
ln -s "$top/common/matching" "$work/shoal/matching"
ln -s "$top/common/base/"*.h "$work/shoal/"
# One file: what the headers take is most of the time.
printf '#include "%s"\n' "$top"/common/matching/*.cc "$top/tests/matching/print_clusterings.cc" > "$work/all.cc"

# printed_by NAME RUNNER COMPILER FLAGS...: what that build prints, in $work/NAME.txt
printed_by() {
  local name=$1 runner=$2
  shift 2
  # nlohmann's header is named by itself: all of /usr/include would hide a cross compiler's own.
  "$@" -std=c++20 -I"$work" -isystem "$eigen" -isystem "$work/system" "$work/all.cc" -o "$work/$name"
  $runner "$work/$name" ${cases:+"$cases"} > "$work/$name.txt"
}
mkdir "$work/system"
ln -s /usr/include/nlohmann "$work/system/nlohmann"

printed_by reference "" g++ -O1
status=0
# alike NAME RUNNER COMPILER FLAGS...
alike() {
  if ! command -v "$3" > /dev/null || { [[ -n $2 ]] && ! command -v "${2%% *}" > /dev/null; }; then
    echo "$1: left out, ${2:+$2 or }$3 is not installed"
    return
  fi
  printed_by "$@"
  if cmp -s "$work/reference.txt" "$work/$1.txt"; then
    echo "$1: $(wc -l < "$work/$1.txt") clusterings alike"
  else
    echo "$1: DIFFERS in $(diff "$work/reference.txt" "$work/$1.txt" | grep -c '^>') clusterings"
    status=1
  fi
}
no_avx=()
[[ $(uname -m) != x86_64 ]] || no_avx=(-march=native -mno-avx)
alike gcc-O3-no-avx "" g++ -O3 "${no_avx[@]}"
alike clang "" clang++ -O2
alike aarch64 "qemu-aarch64 -L /usr/aarch64-linux-gnu" aarch64-linux-gnu-g++ -O2
exit $status
