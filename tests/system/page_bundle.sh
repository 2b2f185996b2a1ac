#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# page_bundle.sh SOURCES SCRATCH: fetches the page's pinned packages into SCRATCH, checks its types, builds it, and
# compares the bundle with the committed one. SCRATCH then serves the tests of the page and of exports.
set -euo pipefail
sources=$1 scratch=$2
rm -rf "$scratch"
mkdir -p "$scratch"
cp -r "$sources"/{src,package.json,package-lock.json,.npmrc,tsconfig.json,page_test.mjs,page_live_test.mjs,page_benchmark.mjs,mcap_read.mjs} "$scratch/"
cd "$scratch"
npm ci --ignore-scripts --silent
npm run --silent check
npm run --silent build
if ! diff -r dist "$sources/dist"; then
  echo "operator_console/web/dist is not what its sources make; build it: npm ci && npm run build" >&2
  exit 1
fi
