// SPDX-License-Identifier: BSD-3-Clause
// node page_benchmark.mjs URL SECONDS: how long the page takes to open, what an update weighs, and how long frames take while a
// hand moves the map. tests/system/page_benchmark.py starts it.
import { chromium } from "playwright-core";

const [url, seconds] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"] });
const middle = (values, share = 0.5) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(values.length * share))];
try {
  while (!(await (await fetch(new URL("/api/mission", url))).json()).sequence) await new Promise((r) => setTimeout(r, 50));
  const opened = [];
  let page;
  for (let i = 0; i < 5; ++i) {
    await page?.close();
    page = await browser.newPage({ viewport: { width: 1400, height: 860 } });
    const begun = Date.now();
    await page.goto(url);
    await page.waitForFunction(() => window.shoal?.map.lastFrameMs > 0 && !window.shoal.map.isEmpty);
    opened.push(Date.now() - begun);
  }
  console.log(`opens in ${middle(opened)} ms (of 5: ${opened.join(", ")}), the whole map is ${(await page.evaluate(() => window.shoal.bytes / 1e6)).toFixed(1)} MB before gzip`);

  // What comes over the wire, by path.
  const link = await page.context().newCDPSession(page);
  await link.send("Network.enable");
  const paths = new Map(), weights = {};
  const changed = []; // maps with new cells
  let maps = 0;
  link.on("Network.requestWillBeSent", (e) => paths.set(e.requestId, new URL(e.request.url).pathname));
  link.on("Network.loadingFinished", (e) => {
    const path = paths.get(e.requestId);
    if (path === undefined) return;
    (weights[path] ??= []).push(e.encodedDataLength);
    if (path !== "/api/map") return;
    ++maps;
    if (e.encodedDataLength > 1000) changed.push(e.encodedDataLength); // more than a header
  });
  const frames = await page.evaluate(async (ms) => {
    const { map } = window.shoal, intervals = [], drawn = [];
    const begun = performance.now();
    let before = begun;
    while (performance.now() - begun < ms) {
      const t = (performance.now() - begun) / 1000;
      map.pan(6 * Math.cos(t), 6 * Math.sin(1.3 * t));
      if (Math.floor(t * 10) % 5 === 0) map.zoom(1 + 0.01 * Math.sin(t));
      await new Promise(requestAnimationFrame);
      const now = performance.now();
      intervals.push(now - before);
      drawn.push(map.lastFrameMs);
      before = now;
    }
    return { intervals, drawn };
  }, 1000 * Number(seconds));
  const kB = (list) => (list.reduce((a, b) => a + b, 0) / maps / 1000).toFixed(1);
  console.log(`updates: ${(maps / Number(seconds)).toFixed(1)} a second, ${kB(Object.values(weights).flat())} kB each on the wire (${Object.entries(weights).map(([path, list]) => `${path.slice(5)} ${kB(list)}`).join(", ")})`);
  console.log(`new cells: ${(changed.length / Number(seconds)).toFixed(2)} times a second, ${(changed.length ? middle(changed) / 1000 : 0).toFixed(1)} kB each`);
  console.log(`frames while moving: ${frames.intervals.length / Number(seconds)} a second, median ${middle(frames.intervals).toFixed(1)} ms, 95 % ${middle(frames.intervals, 0.95).toFixed(1)} ms, longest ${Math.max(...frames.intervals).toFixed(0)} ms; drawing takes ${middle(frames.drawn).toFixed(1)} ms (95 %: ${middle(frames.drawn, 0.95).toFixed(1)})`);
} finally {
  await browser.close();
}
