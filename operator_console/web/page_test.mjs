// SPDX-License-Identifier: BSD-3-Clause
// The page in Debian's chromium. Usage: node page_test.mjs URL_WITH_TOKEN [FOLDER FOR SCREENSHOTS]
// The mission is a recording of three robots over a reef. Exit code 1 and what was expected when something fails.
import assert from "node:assert/strict";
import { chromium } from "playwright-core";

const [url, folder] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"] });
const page = await browser.newPage({ viewport: { width: 1400, height: 860 } });
const problems = [];
page.on("pageerror", (error) => problems.push(String(error)));
page.on("request", (request) => { if (!request.url().startsWith(new URL(url).origin) && !request.url().startsWith("data:")) problems.push("asks " + request.url()); });
const shot = (name) => (folder ? page.screenshot({ path: `${folder}/${name}.png` }) : undefined);
const text = (selector) => page.locator(selector).innerText();
const cells = async () => Number((await text("#counts")).split(" ")[0].replace(/,/g, ""));
const until = async (what, why) => {
  for (let i = 0; i < 150; ++i) { if (await what()) return; await page.waitForTimeout(100); }
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
  await page.locator("#map").click({ position: { x: 846, y: 320 } });
  await page.waitForSelector("#inspector .why table");
  assert.match(await text("#inspector"), /Why are these the same\?/i);
  assert.match(page.url(), /label=\d+/);
  await shot("why");

  // A name, and back.
  await page.keyboard.press("n");
  await page.locator("#legend input").fill("<i>reef & sand</i>");
  await page.keyboard.press("Enter");
  await page.waitForSelector('#legend .name:text-is("<i>reef & sand</i>")', { timeout: 20000 });
  await page.locator("#undo").click();
  await until(async () => !(await text("#legend")).includes("reef & sand"), "the name is taken back");

  // Layers by key, and time.
  for (const [key, layer] of [["2", "certainty"], ["3", "age"], ["4", "robot"], ["5", "coverage"], ["1", "label"]]) {
    await page.keyboard.press(key);
    assert.equal(await page.locator("#layers [aria-checked=true]").getAttribute("data-layer"), layer);
    if (layer !== "label") await shot(layer);
  }
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

  // It survives a reload, with its key.
  await page.reload();
  await page.waitForSelector("#legend .label");
  await until(async () => !(await page.locator("#undo").isHidden()), "the key is kept");
  await page.keyboard.press("Escape");
  await page.keyboard.press("0");
  await page.waitForTimeout(300);
  await shot("whole");
  assert.deepEqual(problems, []);
  console.log("the page works");
} catch (error) {
  await shot("failed");
  console.error(error, problems);
  process.exitCode = 1;
} finally {
  await browser.close();
}
