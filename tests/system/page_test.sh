#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# page_test.sh BIN_DIR WEB_DIR [SCREENSHOTS]: flies a small mission, serves its recording and that of who heard some of it
# late, and looks at the page in chromium. WEB_DIR holds page_test.mjs and its packages.
set -euo pipefail
bin=$1 web=$2 shots=${3-} here=$(dirname "$0")
top=$(mktemp -d)
servers=()
trap '[[ ${#servers[@]} -eq 0 ]] || kill "${servers[@]}" 2>/dev/null || true; rm -rf "$top"' EXIT
"$bin/operator_console" --log-level error launch --world reef:tuning --robots 3 --observations 12 --seed 3 --record --out "$top/run"
cp -r "$top/run" "$top/late"
python3 "$here/heard_late.py" "$top/run/mission.lcmlog" "$top/late/mission.lcmlog"
urls=()
for run in run late; do
  mkfifo "$top/$run.said"
  "$bin/operator_console" serve --run "$top/$run" --port 0 --json >"$top/$run.said" &
  servers+=($!)
  read -r line <"$top/$run.said"
  urls+=("$(python3 -c 'import json, sys; print(json.loads(sys.argv[1])["url"])' "$line")")
done
cd "$web"
node page_test.mjs "${urls[@]}" $shots
