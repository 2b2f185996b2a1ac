#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# spy_test.sh BIN GOLDEN OUT: lcm-spy, started by BIN/shoal-spy, knows our types and decodes the messages of
# the folder GOLDEN. Leaves a screenshot in OUT. Run it in a network namespace of its own.
set -euo pipefail
bin=$1 golden=$2 out=$3
here=$(dirname "$(readlink -f "$0")")
work=$(mktemp -d)
children=()
trap 'kill "${children[@]}" 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$work"' EXIT
fail() {
  echo "spy_test: $1" >&2
  exit 1
}
url='udpm://239.255.76.67:7667?ttl=0'

# The classes that the spy finds, and what they make of the golden bytes, field by field.
jars=/usr/share/java/lcm.jar:$bin/../share/shoal/shoal_types.jar
javac -nowarn -cp "$jars" -d "$work" "$here/DecodeGolden.java"
java -cp "$jars:$work" DecodeGolden "$golden" 2>"$work/decode.err" || fail "decoding: $(cat "$work/decode.err")"

# Without a display there is one clear line.
if DISPLAY= "$bin/shoal-spy" 2>"$work/no_display.err"; then fail "started without a display"; fi
grep -q '^shoal-spy: no display' "$work/no_display.err" || fail "no clear error without a display"

# The window itself.
exec 3<>"$work/display"
Xvfb -displayfd 3 -screen 0 1280x900x24 -nolisten tcp >"$work/xvfb.log" 2>&1 &
children+=($!)
for _ in $(seq 100); do
  [ -s "$work/display" ] && break
  sleep 0.1
done
DISPLAY=:$(cat "$work/display")
export DISPLAY
"$bin/shoal-spy" "--lcm-url=$url" >"$work/spy.out" 2>"$work/spy.err" &
spy=$!
children+=("$spy")
"$bin/publish_messages" "$url" 60 SHOAL_R03_HEARTBEAT "$golden/heartbeat.bin" SHOAL_R03_TOPICS "$golden/topics.bin" \
  SHOAL_R03_BRICK "$golden/bricks.bin" SHOAL_R03_CERTAINTY "$golden/certainties.bin" \
  SHOAL_OPERATOR_MATCHES "$golden/matches.bin" SHOAL_OPERATOR_LABELS "$golden/labels.bin" \
  SHOAL_OPERATOR_MAP "$golden/map_1.bin" >"$work/publish.log" 2>&1 &
children+=($!)

window=
for _ in $(seq 300); do
  window=$(xdotool search --name 'LCM Spy' 2>/dev/null | head -1) || true
  if [ -n "$window" ] && grep -q 'Found .* LCM types' "$work/spy.out"; then break; fi
  kill -0 "$spy" 2>/dev/null || fail "the spy ended: $(cat "$work/spy.err")"
  sleep 0.1
done
[ -n "$window" ] || fail "no window: $(cat "$work/spy.out" "$work/spy.err")"
found=$(sed -n 's/^Found \([0-9]*\) LCM types.*/\1/p' "$work/spy.out")
[ "${found:-0}" -ge 7 ] || fail "the spy found ${found:-no} types of 7: $(cat "$work/spy.out")"

sleep 3
xdotool mousemove 60 108 click --repeat 2 --delay 60 1  # SHOAL_R03_HEARTBEAT: opens its fields
sleep 2
import -window root "$out/spy.png"
if grep -q -i -E 'exception|error' "$work/spy.err" "$work/spy.out"; then fail "$(cat "$work/spy.err" "$work/spy.out")"; fi
echo "spy_test: $found types, screenshot $out/spy.png"
