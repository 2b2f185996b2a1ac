#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# run_decode_fuzzer.sh FUZZER GOLDEN_FOLDER SECONDS: fuzzes from the golden messages.
set -eu
corpus=$(mktemp -d)
trap 'rm -rf "$corpus"' EXIT
kind=0
for name in heartbeat topics brick certainty matches labels map_1; do  # in the order of MessageKind
  { printf "\\x0$kind"; cat "$2/$name.bin"; } > "$corpus/$name"
  kind=$((kind + 1))
done
"$1" -max_total_time="$3" -max_len=1392 -timeout=2 -rss_limit_mb=1024 -print_final_stats=1 \
  -artifact_prefix="$corpus/../" "$corpus"
