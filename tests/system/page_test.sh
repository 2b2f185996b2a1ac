#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# page_test.sh BIN_DIR WEB_DIR [SCREENSHOTS]: flies a small mission, serves its recording, and looks at the page in
# chromium. WEB_DIR holds page_test.mjs and its packages.
set -euo pipefail
bin=$1 web=$2 shots=${3-}
top=$(mktemp -d)
server=
trap '[[ -z $server ]] || kill "$server" 2>/dev/null || true; rm -rf "$top"' EXIT
"$bin/operator_console" --log-level error launch --world reef:tuning --robots 3 --observations 12 --seed 3 --record \
  --out "$top/run"
mkfifo "$top/said"
"$bin/operator_console" serve --run "$top/run" --port 0 --json >"$top/said" &
server=$!
read -r line <"$top/said"
url=$(python3 -c 'import json, sys; print(json.loads(sys.argv[1])["url"])' "$line")
cd "$web"
node page_test.mjs "$url" $shots
