#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# page_test.sh BIN_DIR WEB_DIR [SCREENSHOTS]: flies a small mission, and one on a link that loses three messages in ten,
# serves their recordings, and looks at the page in chromium. WEB_DIR holds page_test.mjs and its packages.
set -euo pipefail
bin=$1 web=$2 shots=${3-}
top=$(mktemp -d)
servers=()
trap '[[ ${#servers[@]} -eq 0 ]] || kill "${servers[@]}" 2>/dev/null || true; rm -rf "$top"' EXIT
echo '{"loss": 0.3}' >"$top/bad_link.json"
mission=(--world reef:tuning --robots 3 --observations 12 --seed 3 --record)
"$bin/operator_console" --log-level error launch "${mission[@]}" --out "$top/run"
"$bin/operator_console" --log-level error launch "${mission[@]}" --link "$top/bad_link.json" --out "$top/lossy"
urls=()
for run in run lossy; do
  mkfifo "$top/$run.said"
  "$bin/operator_console" serve --run "$top/$run" --port 0 --json >"$top/$run.said" &
  servers+=($!)
  read -r line <"$top/$run.said"
  urls+=("$(python3 -c 'import json, sys; print(json.loads(sys.argv[1])["url"])' "$line")")
done
cd "$web"
node page_test.mjs "${urls[@]}" $shots
