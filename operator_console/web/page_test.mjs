// SPDX-License-Identifier: BSD-3-Clause
// The page in Debian's chromium. Usage: node page_test.mjs URL_WITH_TOKEN URL_OF_ONE_HEARD_LATE [FOLDER FOR SCREENSHOTS]
// The missions are recordings of three robots over a reef, the second one by who heard some messages late. Exit code 1 and what was expected when something fails.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { chromium } from "playwright-core";

const [url, lateUrl, folder] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
const page = await browser.newPage({ viewport: { width: 1400, height: 860 } });
const problems = [];
page.on("pageerror", (error) => problems.push(String(error)));
page.on("request", (request) => { if (!request.url().startsWith(new URL(url).origin) && !request.url().startsWith("data:")) problems.push("asks " + request.url()); });
const asked = new Map(); // all that the page asks: method and path, with the parameters it ever gave
page.on("request", (request) => {
  const { pathname, searchParams } = new URL(request.url()), key = `${request.method().toLowerCase()} ${pathname}`;
  if (pathname.startsWith("/api/")) asked.set(key, new Set([...asked.get(key) ?? [], ...searchParams.keys()]));
});
const shot = (name) => (folder ? page.screenshot({ path: `${folder}/${name}.png` }) : undefined);
const text = (selector) => page.locator(selector).innerText();
const cells = async () => Number((await text("#counts")).split(" ")[0].replace(/,/g, ""));
const until = async (what, why) => {
  for (const start = Date.now(); Date.now() - start < 60000; await page.waitForTimeout(100)) if (await what()) return;
  assert.fail(why);
};
try {
  await page.goto(url);
  await until(async () => (await text("#phase")) === "finished run" || (await text("#phase")) === "recording", "the recording is read");
  await page.waitForSelector("#legend .label");
  assert.ok(!page.url().includes("token"), "the key has left the address bar");
  await shot("first");

  // Something is drawn in the legend's colours.
  const drawn = await page.evaluate(() => {
    const canvas = document.getElementById("map"), pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const seen = new Set();
    for (let i = 0; i < pixels.length; i += 4) seen.add(`rgb(${pixels[i]}, ${pixels[i + 1]}, ${pixels[i + 2]})`);
    return [...document.querySelectorAll("#legend .swatch")].map((s) => getComputedStyle(s).backgroundColor).map((c) => seen.has(c));
  });
  assert.ok(drawn.length > 1 && drawn[0] && drawn[1], "the largest labels are on the map: " + drawn);

  // What is here, and why.
  const mapped = () => page.evaluate(() => { // somewhere that was seen, away from what lies over the map
    const { map } = window.shoal;
    for (let x = 100; x < map.canvas.clientWidth - 100; x += 7) for (let y = 150; y < map.canvas.clientHeight - 100; y += 7)
      if (map.cellAt(...map.toWorld(x, y))) return { x, y };
    return null;
  });
  await page.locator("#map").click({ position: await mapped() });
  await page.waitForSelector("#inspector .why table");
  assert.match(await text("#inspector"), /Why are these the same\?/i);
  assert.match(page.url(), /label=\d+/);
  await shot("why");

  // What labels look like, in the legend and beside the evidence.
  await until(async () => (await page.locator("#legend img.example").count()) > 1, "labels have pictures");
  const loaded = (where) => page.evaluate((w) => [...document.querySelectorAll(w + " img.example")].map((i) => i.complete ? i.naturalWidth : 0), where);
  await until(async () => (await loaded("#legend")).every((width) => width === 32), "the legend's pictures come");
  await until(async () => { const widths = await loaded("#inspector .face"); return widths.length > 0 && widths.every((w) => w === 32); }, "the evidence has pictures");

  // A picture closer; of a mission that is over nothing can be asked for.
  await page.locator("#inspector .look").first().click();
  assert.match(await text("#inspector .closer"), /As R0\d saw its topic \d+ at [^]*over/);
  await page.locator("#inspector .look").first().click();
  assert.equal(await page.locator("#inspector .closer").count(), 0);

  // A name, and back.
  await page.keyboard.press("n");
  await page.locator("#legend input").fill("<i>reef & sand</i>");
  await page.keyboard.press("Enter");
  await page.waitForSelector('#legend .name:text-is("<i>reef & sand</i>")');
  await page.locator("#undo").click();
  await until(async () => !(await text("#legend")).includes("reef & sand"), "the name is taken back");

  // The same as another, something else, never been there: by mouse, each taken back.
  await page.keyboard.press("Escape");
  const legend = () => page.evaluate(() => [...document.querySelectorAll("#legend .label")].map((row) => row.dataset.key).sort());
  const said = async (pattern) => until(async () => pattern.test(await text("#toast")), "it is said: " + pattern);
  if (await page.locator("#legend .rare").count() > 0) await page.locator("#legend .rare").click();
  const apart = await legend(), total = await cells();
  const pair = await page.evaluate(() => [...document.querySelectorAll("#legend .label")].slice(0, 2).map((row) => row.dataset.key));
  await page.locator("#legend .label").nth(0).click();
  await page.locator("#inspector .buttons button", { hasText: "Same as" }).click();
  await said(/choose the label that is the same/);
  await page.locator("#legend .label").nth(1).click();
  await said(/ same /);
  await until(async () => { const now = await legend(); return pair.filter((key) => now.includes(key)).length === 1; }, "two labels are one: " + pair);
  await shot("linked");
  await page.locator("#toast button").click();
  await said(/^Undone: .* are the same$/);
  await until(async () => (await legend()).join() === apart.join(), "two again: " + apart);
  await page.locator("#legend .label").nth(0).click();
  await page.locator("#inspector .buttons button", { hasText: "Same as" }).click();
  await page.keyboard.press("Escape"); // none after all
  await page.locator("#legend .label").nth(1).click();
  await page.waitForSelector("#inspector .why table");
  assert.equal((await legend()).length, apart.length);

  const members = () => page.evaluate(() => [...document.querySelectorAll("#inspector .why tr td:nth-child(2)")].map((e) => e.innerText.replace(/\s*other$/, "")));
  let rows = 0;
  for (; await page.locator("#inspector .why tr button.small").count() === 0; ++rows) { // a label that more than one robot knows
    await page.locator("#legend .label").nth(rows).click();
    await page.waitForSelector("#inspector .why table");
  }
  const alike = await members(), odd = page.locator("#inspector .why tr", { has: page.locator("button.small") }).first();
  await odd.hover();
  await odd.locator("button.small").click();
  await said(/ not /);
  await until(async () => (await members()).length < alike.length, "it is taken out of the label");
  await page.keyboard.press("u");
  await until(async () => (await members()).join() === alike.join(), "and is back: " + alike);
  await page.keyboard.press("Escape");

  const out = page.locator('#robots [data-key="exclude R01"]');
  await page.locator("#robots [data-key=R01]").hover();
  page.once("dialog", (question) => question.dismiss());
  await out.click();
  await page.waitForTimeout(500);
  assert.equal(await cells(), total, "whoever says no has changed nothing");
  let asks = "";
  page.once("dialog", (question) => { asks = question.message(); return question.accept(); });
  await page.locator("#robots [data-key=R01]").hover();
  await out.click();
  assert.match(asks, /as if R01 had never been there\? Undo/);
  await until(async () => (await cells()) < total, "its cells are gone");
  await until(async () => !(await text("#legend")).includes("only R01"), "so are its labels");
  await shot("excluded");
  await page.locator("#undo").click();
  await until(async () => (await cells()) === total && (await legend()).join() === apart.join(), "all is as it was");

  // A name as long as a name may be stays within its place.
  for (const name of ["W".repeat(64), "\u{1F41F}".repeat(16)]) {
    await page.locator("#legend .label .name").first().dblclick();
    await page.locator("#legend input").fill(name);
    assert.match(await text("#legend .naming"), /Enter keeps it/);
    await page.keyboard.press("Enter");
    await page.waitForSelector(`#legend .name:text-is("${name}")`);
    await page.locator("#legend .label").first().click();
    await page.waitForSelector("#inspector .why table");
    for (const [width, height] of [[1400, 860], [390, 844]]) {
      await page.setViewportSize({ width, height });
      const sticking = await page.evaluate(() => {
        const within = (e, box) => { const a = e.getBoundingClientRect(), b = box.getBoundingClientRect(); return a.width === 0 || (a.left >= b.left - 1 && a.right <= b.right + 1); };
        const inspector = document.getElementById("inspector"), aside = document.querySelector("aside");
        return [...inspector.querySelectorAll("*")].filter((e) => !within(e, inspector)).concat([...aside.querySelectorAll("#legend *")].filter((e) => !within(e, aside)), within(document.getElementById("toast"), document.body) ? [] : ["toast"]).map((e) => e.className || e.tagName || e);
      });
      assert.deepEqual(sticking, [], `${name} at ${width}`);
      await shot(`long_name_${width}`);
    }
    await page.setViewportSize({ width: 1400, height: 860 });
    await page.keyboard.press("u");
    await until(async () => !(await text("#legend")).includes(name), "the name is taken back");
  }

  // Layers by key, and time.
  for (const [key, layer] of [["2", "certainty"], ["3", "surprise"], ["4", "age"], ["5", "robot"], ["6", "coverage"], ["7", "truth"], ["1", "label"]]) {
    await page.keyboard.press(key);
    assert.equal(await page.locator("#layers [aria-checked=true]").getAttribute("data-layer"), layer);
    if (layer === "truth") {
      await until(async () => (await page.locator("#ramp .class").count()) > 1, "the truth has its classes");
      const colors = await page.evaluate(() => [...document.querySelectorAll("#ramp .swatch")].map((s) => getComputedStyle(s).backgroundColor));
      await until(async () => page.evaluate((wanted) => {
        const canvas = document.getElementById("map"), pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
        for (let i = 0; i < pixels.length; i += 4) if (wanted.includes(`rgb(${pixels[i]}, ${pixels[i + 1]}, ${pixels[i + 2]})`)) return true;
        return false;
      }, colors), "the truth is drawn");
    }
    if (layer === "surprise") {
      assert.match(await text("#ramp"), /as usual[^]*surprised: 1.5[^]*6 and more/);
      await until(async () => (await page.locator("#ramp .places button").count()) > 0, "the strangest places are told");
      const most = Number(await page.locator("#ramp .places button").first().innerText());
      const known = await page.evaluate(() => Math.max(...[...window.shoal.map.tiles.values()].flatMap((t) => [...t.surprise, ...t.lower.surprise])) / 8);
      assert.ok(most >= 2 && Math.abs(known - most) < 0.06, `the strangest is the map's most: ${most}, ${known}`);
      await shot("surprise_all");
      await page.locator("#ramp .places button").first().click();
      await until(async () => /it surprised: [2-7]\.\d/.test(await text("#inspector")), "the place says how much it surprised");
    }
    if (layer !== "label") await shot(layer);
    if (layer === "surprise") { await page.keyboard.press("Escape"); await page.keyboard.press("0"); }
  }

  // In 3-D, and flat again at the same place.
  await page.keyboard.press("Escape"); // the chosen label fades all others
  const fetched = [];
  page.on("request", (request) => fetched.push(new URL(request.url()).pathname));
  await page.keyboard.press("d");
  await page.waitForFunction(() => window.shoal.depth?.drawn > 0);
  assert.ok(fetched.includes("/view3d.js"), "3-D is fetched when it is wanted");
  await until(async () => (await page.evaluate(() => window.shoal.depth.drawn)) === (await cells()), "3-D has every cell");
  const boxes = await page.evaluate(() => { // tops are in the legend's colours
    const { depth } = window.shoal, copy = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    copy.canvas.width = depth.canvas.width; copy.canvas.height = depth.canvas.height;
    depth.frame(depth.canvas.clientWidth, depth.canvas.clientHeight);
    copy.drawImage(depth.canvas, 0, 0);
    const pixels = copy.getImageData(0, 0, copy.canvas.width, copy.canvas.height).data, seen = new Set();
    for (let i = 0; i < pixels.length; i += 4) seen.add(`rgb(${pixels[i]}, ${pixels[i + 1]}, ${pixels[i + 2]})`);
    return [...document.querySelectorAll("#legend .swatch")].map((s) => getComputedStyle(s).backgroundColor).map((c) => seen.has(c));
  });
  assert.ok(boxes[0] && boxes[1], "the largest labels are there in 3-D: " + boxes);
  const spot = await page.evaluate(() => { // a cell, where it is on the screen, and what the eye meets there
    const { map, depth } = window.shoal;
    for (const tile of map.tiles.values()) for (let i = 0; i < 1024; ++i) if (tile.label[i] >= 0) {
      const cell = map.cellOf(tile, tile, i, i), at = depth.project(cell.x, cell.y, cell.z);
      if (at && at[0] > 100 && at[0] < 500 && at[1] > 150 && at[1] < map.canvas.clientHeight - 100) return { x: at[0], y: at[1], cell, met: depth.pick(...at) };
    }
  });
  assert.ok(Math.abs(spot.met.x - spot.cell.x) <= 1 && Math.abs(spot.met.y - spot.cell.y) <= 2, "the eye meets that cell: " + JSON.stringify(spot));
  await page.locator("#map").click({ position: spot });
  await page.waitForSelector("#inspector .why table");
  await shot("3d_why");
  await page.keyboard.press("Escape");
  const eye = () => page.evaluate(() => { const { azimuth, elevation, distance } = window.shoal.depth; return { azimuth, elevation, distance }; });
  const before3d = await eye();
  await page.mouse.move(300, 500); await page.mouse.down(); await page.mouse.move(400, 450, { steps: 5 }); await page.mouse.up();
  await page.mouse.wheel(0, -300);
  const after3d = await eye();
  assert.ok(after3d.azimuth !== before3d.azimuth && after3d.elevation !== before3d.elevation && after3d.distance < before3d.distance, "hands turn and zoom");
  await page.waitForTimeout(300);
  await shot("3d");
  const spatial = await (await browser.newContext()).newPage();
  await spatial.goto(page.url());
  await spatial.waitForFunction(() => window.shoal.depth?.drawn > 0);
  const told = await spatial.evaluate(() => window.shoal.depth.azimuth);
  assert.ok(Math.abs(told - after3d.azimuth) < 0.1, `the link tells where the eye was: ${told}, ${after3d.azimuth}`);
  await spatial.close();
  await page.keyboard.press("d");
  assert.ok(await page.locator("#depth").isHidden(), "flat again");
  await page.keyboard.press("0");
  await page.locator("#map").click({ position: await mapped() });

  // Files for other programs; on Earth only when it is said where.
  await page.keyboard.press("e");
  assert.equal(await page.locator("#exports a.off").count(), 1);
  const saved = async (format) => {
    const [download] = await Promise.all([page.waitForEvent("download"), page.locator(`#exports [data-format=${format}]`).click()]);
    return [download.suggestedFilename(), readFileSync(await download.path())];
  };
  const [zipName, zip] = await saved("geotiff");
  assert.equal(zipName, "map.tif.zip");
  assert.equal(zip.subarray(0, 4).toString("latin1"), "PK\x03\x04");
  await page.locator("#atlatitude").fill("-17.5");
  assert.match(await text("#exports .fault"), /longitude/);
  await page.locator("#atlongitude").fill("177.25");
  const [kmlName, kml] = await saved("kml");
  assert.equal(kmlName, "map.kml");
  assert.match(kml.toString(), /177\.2[0-9]+,-17\.[0-9]+/);
  await shot("exports");
  await page.locator("#exports button").click();

  await until(async () => !(await page.locator("#time").isDisabled()), "there is a history");
  const all = await cells();
  await until(async () => { await page.keyboard.press("["); return (await cells()) < all; }, "fewer cells were known then");
  assert.equal(await text("#phase"), "as it was");
  await shot("past");
  const link = page.url();
  await page.locator("#now").click();
  await until(async () => (await cells()) === all, "now is all");

  // The link shows the same to somebody else, who may look and not touch.
  const other = await (await browser.newContext()).newPage();
  await other.goto(link);
  await other.waitForSelector("#legend .label");
  await until(async () => (await other.locator("#phase").innerText()) === "as it was", "a link goes to its time");
  assert.ok(await other.locator("#undo").isHidden(), "no key, no undo");
  await other.close();

  // What came named from the library says so. (tests/system/serve_test.py flies a mission with one.)
  const marked = await (await browser.newContext()).newPage();
  await marked.route("**/api/labels*", async (route) => {
    const response = await route.fetch(), answer = await response.json();
    answer.labels.forEach((l) => (l.library = []));
    answer.labels.reduce((a, b) => (a.area_m2 > b.area_m2 ? a : b)).library = ["sand & <b>silt</b>"];
    await route.fulfill({ response, json: answer });
  });
  await marked.goto(url);
  await marked.waitForSelector("#legend .library");
  assert.equal(await marked.locator("#legend .library").count(), 1);
  assert.match(await marked.locator("#legend .label").first().locator(".library").getAttribute("title"), /knows it as “sand & <b>silt<\/b>”/);
  if (folder) await marked.screenshot({ path: `${folder}/library.png` });
  await marked.close();

  // Without a mouse: the map's middle, a label, what its robots are, the list of keys.
  const bare = await (await browser.newContext({ viewport: { width: 1400, height: 860 } })).newPage();
  await bare.goto(url);
  await bare.waitForSelector("#legend .label");
  await until(async () => bare.evaluate(() => !window.shoal.map.isEmpty), "the map is there");
  const focused = () => bare.evaluate(() => { const e = document.activeElement; return e.id || e.dataset.key || e.dataset.layer || e.className || e.tagName; });
  const reached = new Set();
  const tabTo = async (wanted) => {
    for (let i = 0; i < 120; ++i) {
      await bare.keyboard.press("Tab");
      const now = await focused();
      reached.add(now);
      const line = await bare.evaluate(() => { const style = getComputedStyle(document.activeElement); return style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0 && style.opacity === "1"; });
      assert.ok(line || now === "BODY", "who has the focus shows it: " + now);
      if (wanted(now)) return;
    }
    assert.fail("Tab comes to it; it came to " + [...reached].join(", "));
  };
  await tabTo((now) => now === "map");
  await until(() => bare.evaluate(() => { // there is something under the cross
    const { map } = window.shoal;
    if (map.cellAt(...map.toWorld(...map.cross()))) return true;
    map.pan(7, 5);
    return false;
  }), "a cell under the cross");
  await bare.keyboard.press("Enter");
  await bare.waitForSelector("#inspector .why table");
  await bare.keyboard.press("Escape");
  assert.ok(await bare.locator("#inspector").isHidden());
  await tabTo((now) => now.startsWith("label "));
  const row = await focused();
  await bare.keyboard.press("Enter");
  await bare.waitForSelector("#inspector .why table");
  assert.equal(await focused(), row, "the focus stays where it was while rows are made anew");
  await tabTo((now) => now === "exclude R00");
  await tabTo((now) => now === "R01");
  await bare.keyboard.press("Space");
  assert.match(bare.url(), /robot=1/);
  await tabTo((now) => now === "time");
  await bare.keyboard.press("?");
  const keys = await bare.locator("#keys").innerText();
  for (const key of ["arrows", "Tab", "Enter", "1 … 7", "[ ] space", "Esc"]) assert.ok(keys.includes(key), key + " is in the list: " + keys);
  for (const key of ["d", "n", "l", "u", "e", "c", "?"]) assert.ok((await bare.locator("#keys kbd").allInnerTexts()).includes(key), key + " is in the list");
  await bare.keyboard.press("Escape");
  await bare.close();

  // Nothing lies over anything that can be pressed, on a desk, a small laptop and a telephone.
  for (const [width, height] of [[1400, 860], [1024, 700], [390, 844]]) {
    const small = await (await browser.newContext({ viewport: { width, height } })).newPage();
    await small.goto(url);
    await small.waitForSelector("#legend .label");
    await small.locator("#layers [data-layer=surprise]").click();
    await small.waitForTimeout(200);
    const hidden = await small.evaluate(() => [...document.querySelectorAll("header button, #layers button, #toggles button, #toggles input, #ramp, footer button, footer input")].filter((e) => {
      const box = e.getBoundingClientRect();
      if (box.width === 0) return false;
      return box.left < 0 || box.right > innerWidth || box.bottom > innerHeight || !e.contains(document.elementFromPoint((box.left + box.right) / 2, (box.top + box.bottom) / 2));
    }).map((e) => e.id || e.dataset.layer));
    assert.deepEqual(hidden, [], `at ${width} x ${height}`);
    assert.ok(await small.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `at ${width} x ${height} nothing sticks out`);
    if (folder) await small.screenshot({ path: `${folder}/size_${width}.png` });
    await small.close();
  }

  // Fingers: two apart zoom around their middle, one moves.
  const touched = await (await browser.newContext({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true })).newPage();
  await touched.goto(url);
  await touched.waitForSelector("#legend .label");
  await until(() => touched.evaluate(() => !window.shoal.map.isEmpty), "the map is there");
  assert.match(await touched.locator("#readout").innerText(), /two fingers: zoom/);
  const hand = await touched.context().newCDPSession(touched), top = (await touched.locator("#map").boundingBox()).y;
  const fingers = (type, ...points) => hand.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y: y + top, id })) });
  const seen = () => touched.evaluate(() => { const { map } = window.shoal; return { scale: map.scale, middle: map.toWorld(195, 300), x: map.center.x }; });
  const flat = await seen();
  await fingers("touchStart", [175, 300]);
  await fingers("touchStart", [175, 300], [215, 300]);
  for (let d = 4; d <= 40; d += 4) await fingers("touchMove", [175 - d, 300], [215 + d, 300]);
  await fingers("touchEnd");
  const near = await seen();
  assert.ok(Math.abs(near.scale / flat.scale - 3) < 0.2, `three times as near: ${near.scale / flat.scale}`);
  for (const i of [0, 1]) assert.ok(Math.abs(near.middle[i] - flat.middle[i]) * near.scale < 8, "what was between the fingers is still there");
  await fingers("touchStart", [195, 300]);
  for (let d = 10; d <= 60; d += 10) await fingers("touchMove", [195 + d, 300]);
  await fingers("touchEnd");
  const beside = await seen();
  assert.ok(beside.scale === near.scale && beside.x < near.x - 30 / near.scale, "one finger moves the map");
  assert.match(touched.url(), /zoom=/, "the link knows");
  assert.equal(await touched.evaluate(() => visualViewport.scale), 1, "the page itself stays as it is");
  await touched.close();

  // The map as one robot holds it, and a link to that.
  await page.locator("#holders").selectOption("R01");
  await until(async () => (await text("#phase")) === "as R01 held it" && (await cells()) < all, "the map as R01 held it");
  assert.match(await text("#holding"), /R01 fuses nothing: it holds its own/);
  assert.ok(await page.locator("#undo").isHidden(), "nothing is decided there");
  await shot("held");
  const theirs = await (await browser.newContext()).newPage();
  await theirs.goto(page.url());
  await until(async () => (await theirs.locator("#phase").innerText()) === "as R01 held it", "the link tells whose map it is");
  await theirs.close();
  await page.locator("#holders").selectOption("");
  await until(async () => (await cells()) === all, "all of it again");

  // Where messages came in another order nobody knows for sure what a node held; the page says so, and that it was whole in the end.
  const late = await (await browser.newContext({ viewport: { width: 1400, height: 860 } })).newPage();
  await late.goto(lateUrl);
  await until(async () => !(await late.locator("#time").isDisabled()), "the mission heard late is read");
  await late.locator("#holders").selectOption("OPERATOR");
  const says = () => late.locator("#holding").innerText();
  await until(async () => /OPERATOR at [^]*: all that 3 of 3 robots had said\. Its own digest says the same\./.test(await says()), "all of it came in the end");
  const finally_ = Number((await late.locator("#counts").innerText()).split(" ")[0].replace(/,/g, ""));
  const known = async (path) => (await fetch(new URL(path, lateUrl))).json();
  let unsure = null;
  for (const t of (await known("/api/mission")).times_s)
    if ((await known(`/api/holding?node=OPERATOR&at=${t}`)).shares?.some((s) => !s.certain && s.robot === "R00")) { unsure = t; break; }
  assert.ok(unsure !== null, "there was a time of which nobody knows");
  await late.goto(new URL(`/#t=${unsure}&node=OPERATOR`, lateUrl).href);
  await late.reload();
  await until(async () => /of R0\d what it said until \d+:\d\d at least/.test(await says()), "what it held at least");
  await until(async () => Number((await late.locator("#counts").innerText()).split(" ")[0].replace(/,/g, "")) < finally_, "which is less");
  if (folder) await late.screenshot({ path: `${folder}/at_least.png` });
  await late.close();

  // It survives a reload, with its key.
  await page.reload();
  await page.waitForSelector("#legend .label");
  await until(async () => !(await page.locator("#undo").isHidden()), "the key is kept");
  await page.keyboard.press("Escape");
  await page.keyboard.press("0");
  await page.waitForTimeout(300);
  await shot("whole");
  // What the page asks is what the description says that there is.
  const { paths } = await (await fetch(new URL("/openapi.json", url))).json();
  assert.ok(asked.size > 10, "the page asks: " + [...asked.keys()].join(", "));
  for (const [key, given] of asked) {
    const [method, path] = key.split(" "), said = paths[path]?.[method];
    assert.ok(said, "described: " + key);
    const known = [...(said.parameters ?? []).map((p) => p.name), ...(path === "/api/picture" ? ["v"] : [])]; // v: which one, for the browser's store
    for (const name of given) assert.ok(known.includes(name), `described: ${name} of ${key}`);
  }
  assert.deepEqual(problems, []);
  console.log("the page works");
} catch (error) {
  await shot("failed");
  console.error(error, problems);
  process.exitCode = 1;
} finally {
  await browser.close();
}
