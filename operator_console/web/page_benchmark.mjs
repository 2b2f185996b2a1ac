// SPDX-License-Identifier: BSD-3-Clause
// node page_benchmark.mjs URL SECONDS: how long the page takes to open, what an update weighs, and how long frames take while a
// hand moves the map, flat and in 3-D. tests/system/page_benchmark.py starts it.
import { chromium } from "playwright-core";

const [url, seconds] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
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
  console.log(`opens in ${middle(opened)} ms (of 5: ${opened.join(", ")}), the whole map is ${(await page.evaluate(() => window.shoal.updates[0].bytes / 1e6)).toFixed(1)} MB before gzip`);

  // What comes over the wire, by path.
  const link = await page.context().newCDPSession(page);
  await link.send("Network.enable");
  const paths = new Map();
  let weights = {};
  link.on("Network.requestWillBeSent", (e) => paths.set(e.requestId, new URL(e.request.url).pathname));
  link.on("Network.loadingFinished", (e) => { const path = paths.get(e.requestId); if (path !== undefined) (weights[path] ??= []).push(e.encodedDataLength); });

  // Moves the map by `move`, a function of seconds, for some time.
  const watch = async (what, move, seconds) => {
    weights = {};
    const seen = await page.evaluate(async ([ms, source]) => {
      const { map, updates, depth } = window.shoal, step = new Function("map", "depth", "t", source), intervals = [], drawn = [];
      const begun = performance.now(), first = updates.length ? updates[updates.length - 1].at : 0;
      let before = begun;
      while (performance.now() - begun < ms) {
        step(map, depth, (performance.now() - begun) / 1000);
        map.draw();
        await new Promise(requestAnimationFrame);
        const now = performance.now();
        intervals.push(now - before);
        drawn.push(map.lastFrameMs);
        before = now;
      }
      const news = updates.filter((u) => u.at > first && u.bytes > 48);
      return { intervals, drawn, news: news.length, bytes: news.map((u) => u.bytes), fetchMs: news.map((u) => u.fetchMs), gaps: news.slice(1).map((u, i) => u.at - news[i].at), cells: depth?.drawn };
    }, [1000 * seconds, move]);
    const { intervals, drawn } = seen, all = Object.values(weights).flat().reduce((a, b) => a + b, 0);
    const mean = (path) => ((weights[path] ?? []).reduce((a, b) => a + b, 0) / Math.max(1, (weights[path] ?? []).length) / 1000).toFixed(1);
    console.log(`${what}: new cells ${(seen.news / seconds).toFixed(2)} times a second` + (seen.news > 1 ? ` (between two: median ${middle(seen.gaps).toFixed(0)} ms, 95 % ${middle(seen.gaps, 0.95).toFixed(0)} ms; asking takes ${middle(seen.fetchMs).toFixed(0)} ms), ${mean("/api/map")} kB each on the wire, ${(middle(seen.bytes) / 1000).toFixed(0)} kB before gzip` : ""));
    console.log(`${what}: ${(all / seconds / 1000).toFixed(1)} kB a second in all (${Object.entries(weights).map(([path, list]) => `${path.slice(5)} ${list.length} x ${mean(path)}`).join(", ")})`);
    console.log(`${what}: ${(intervals.length / seconds).toFixed(1)} frames a second while moving, median ${middle(intervals).toFixed(1)} ms, 95 % ${middle(intervals, 0.95).toFixed(1)} ms, longest ${Math.max(...intervals).toFixed(0)} ms; drawing takes ${middle(drawn).toFixed(1)} ms (95 %: ${middle(drawn, 0.95).toFixed(1)})` + (seen.cells ? `, ${seen.cells} cells` : ""));
  };
  await watch("flat", "map.pan(6 * Math.cos(t), 6 * Math.sin(1.3 * t)); if (Math.floor(t * 10) % 5 === 0) map.zoom(1 + 0.01 * Math.sin(t));", Number(seconds));
  const asked = Date.now();
  await page.keyboard.press("d");
  await page.waitForFunction(() => window.shoal.depth?.drawn > 0);
  console.log(`3-D: there ${Date.now() - asked} ms after the key`);
  await page.waitForTimeout(2000);
  await watch("3-D", "depth.orbit(2 * Math.cos(t), Math.sin(1.3 * t));", Number(seconds));
  if (process.argv[4]) await page.screenshot({ path: process.argv[4] });
} finally {
  await browser.close();
}
