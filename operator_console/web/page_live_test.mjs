// SPDX-License-Identifier: BSD-3-Clause
// The page beside a mission that is flown meanwhile. Usage: node page_live_test.mjs BIN_DIR [FOLDER FOR SCREENSHOTS], in a network
// namespace of its own. Exit code 1 and what was expected when something fails.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, openSync, rmSync } from "node:fs";
import { connect, createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { chromium } from "playwright-core";

const [bin, folder] = process.argv.slice(2);
const top = mkdtempSync(join(tmpdir(), "shoal_live_page_")), state = join(top, "state");
const log = openSync(join(top, "log"), "w"), started = [];
const start = (program, ...options) => {
  const child = spawn(join(bin, program), options, { stdio: ["ignore", "pipe", log] });
  started.push(child);
  child.gone = new Promise((resolve) => child.on("exit", resolve));
  return child;
};
const mission = ["--lcm-url", "udpm://239.255.76.69:7683?ttl=0", "--mission", "livepage"];
const fuse = () => { const node = start("fusion_node", "--node", "OPERATOR", "--state", state, ...mission); node.stdout.resume(); return node; };
const serve = async (port) => {
  const child = start("operator_console", "serve", "--node", state, "--port", String(port), "--json");
  for await (const line of createInterface({ input: child.stdout })) return { child, ...JSON.parse(line) };
  throw new Error("serve said nothing");
};
const command = async (...options) => {
  const child = start("operator_console", "--log-level", "error", ...options);
  let said = "";
  for await (const chunk of child.stdout) said += chunk;
  assert.equal(await child.gone, 0, options.join(" "));
  return JSON.parse(said);
};

const chromium_ = { executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"] };
let browser, laptop;
try {
  let node = fuse();
  const { child: server, url, port } = await serve(0);
  browser = await chromium.launch(chromium_);
  const problems = [];
  const open = async (address) => {
    const page = await (await browser.newContext({ viewport: { width: 1400, height: 860 } })).newPage();
    page.on("pageerror", (error) => problems.push(String(error)));
    await page.goto(address);
    return page;
  };
  const until = async (what, why) => {
    for (const start = Date.now(); Date.now() - start < 60000; await new Promise((r) => setTimeout(r, 100))) if (await what()) return;
    assert.fail(why);
  };
  const page = await open(url), other = await open(url.split("#")[0]);
  const text = (selector, on = page) => on.locator(selector).innerText();
  const cells = async (on = page) => Number((await text("#counts", on)).split(" ")[0].replace(/,/g, "")) || 0;
  const shot = (name) => (folder ? page.screenshot({ path: join(folder, `live_${name}.png`) }) : undefined);

  // The map grows under the eyes of both, with nobody touching anything.
  for (let n = 0; n < 3; ++n)
    start("robot_agent", "--robot", `R0${n}`, "--robots", "3", "--source", "reef:tuning", "--observations", "24", "--budget", "0", "--rate", "4",
      "--out", join(top, "out"), ...mission).stdout.resume();
  const robots = started.slice(-3);
  await until(async () => (await text("#phase")) === "live" && (await cells()) > 0, "the first cells come");
  const some = await cells();
  await until(async () => (await text("#robots")).includes("flying"), "robots fly");
  await until(async () => (await cells()) > some && (await cells(other)) > some, "the map grows on both pages");
  await shot("flying");
  // The price of a sharper picture is said before anybody asks for it; who has no key may know it.
  await until(async () => (await page.locator("#legend img.example").count()) > 0, "a picture has come");
  for (const on of [page, other]) {
    await on.locator("#legend .label", { has: on.locator("img.example") }).first().click();
    await on.locator("#inspector .look").first().click();
    await until(async () => /costs at most [\d.]+ kB on the link|nothing to pay/.test(await text("#inspector .price", on)), "the price is said");
  }
  assert.equal(await other.locator(".pay").count(), 0, "who has no key asks for nothing");
  if (await page.locator(".pay").count() > 0) {
    await page.locator(".pay").click();
    await until(async () => /Asked|has come/.test(await text("#inspector .price")), "it is asked for");
  }
  await shot("price");
  for (const on of [page, other]) await on.keyboard.press("Escape");
  for (const robot of robots) assert.equal(await robot.gone, 0, "a robot came home");
  await until(async () => ((await text("#robots")).match(/landed/g) ?? []).length === 3, "all have landed");
  const whole = (await command("status", "--node", state, "--json")).cells;
  await until(async () => (await cells()) === whole && (await cells(other)) === whole, "both pages have the whole map");
  await until(async () => (await page.locator("#legend img.example").count()) > 1, "pictures have come");

  // Bytes by class of traffic.
  assert.match(await text("#linkkey"), /bricks[^]*heartbeat[^]*topics/);

  // A name given here is on the other page, and with the node.
  await page.locator("#legend .label .name").first().dblclick();
  await page.locator("#legend input").fill("sand & <b>rubble</b>");
  await page.keyboard.press("Enter");
  await until(async () => (await text("#legend", other)).includes("sand & <b>rubble</b>"), "the other page hears of the name");
  assert.ok((await command("labels", "--node", state, "--json")).labels.some((l) => l.name === "sand & <b>rubble</b>"));
  assert.ok(await other.locator("#undo").isHidden(), "who has no key changes nothing");

  // A laptop sleeps: all of its browser stands still, and its lines die without a word to it, as when a radio is off; whoever says
  // something on one afterwards is told so, whoever listens is not. Awake, it knows by its clock that it slept: it does not wait for
  // the lines, has what was decided meanwhile, and hears of what is decided then.
  const lines = new Set();
  const radio = createServer((near) => {
    const line = { far: connect(port, "127.0.0.1"), isDead: false };
    lines.add(line);
    near.on("data", (bytes) => line.isDead ? near.resetAndDestroy() : line.far.write(bytes)).on("error", () => {}).on("close", () => line.far.destroy());
    line.far.on("data", (bytes) => line.isDead || near.write(bytes)).on("error", () => {}).on("close", () => line.isDead || near.destroy());
  }).listen(0, "127.0.0.1");
  await new Promise((resolve) => radio.on("listening", resolve));
  laptop = await chromium.launchServer(chromium_);
  const lid = await (await (await chromium.connect(laptop.wsEndpoint())).newContext()).newPage();
  await lid.goto(`http://127.0.0.1:${radio.address().port}/`);
  await until(async () => (await text("#legend", lid)).includes("sand & <b>rubble</b>"), "the laptop shows the mission");
  const second = await page.evaluate(() => document.querySelectorAll("#legend .name")[1].dataset.label);
  const radioOff = () => { for (const line of lines) { line.isDead = true; line.far.destroy(); } };
  const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  const call = (name) => command("name", second, name, "--node", state, "--json");
  const hasCaughtUp = async (name) => (await text("#legend", lid)).includes(name) && (await text("#phase", lid)) === "live";
  const told = Date.now(); // what it hears last comes later than this, and by that alone it would wait for 25 s more
  await call("mud");
  await until(() => hasCaughtUp("mud"), "it hears of a name");
  radioOff();
  await sleep(2500); // what came before is read, and asked for, not on waking
  process.kill(-laptop.process().pid, "SIGSTOP");
  radioOff(); // a line that it began meanwhile
  await call("dark mud");
  await until(async () => (await text("#legend")).includes("dark mud"), "who is awake hears of it");
  await sleep(8000);
  process.kill(-laptop.process().pid, "SIGCONT");
  await until(() => hasCaughtUp("dark mud"), "the laptop has caught up");
  assert.ok(Date.now() < told + 25000, "it caught up no sooner than by waiting for its lines");
  assert.equal(await cells(lid), whole);
  await call("wet mud");
  await until(() => hasCaughtUp("wet mud"), "and hears of what is new");

  // A cable is pulled while it is awake: nothing tells it, but the server is silent for too long.
  radioOff();
  await call("grey mud");
  await until(() => hasCaughtUp("grey mud"), "the page has found another line");
  await laptop.close();
  laptop = null;
  radio.close();

  // The node goes, and comes back with what it knew.
  node.kill("SIGINT");
  await node.gone;
  await until(async () => (await text("#phase")) === "node not answering", "the page says that the node is gone");
  assert.equal(await cells(), whole, "what was known is still shown");
  await shot("lost");
  node = fuse();
  await until(async () => (await text("#phase")) === "live" && (await cells()) === whole, "the node is back");
  assert.match(await text("#legend"), /sand & <b>rubble<\/b>/);
  await until(async () => ((await text("#robots")).match(/landed/g) ?? []).length === 3, "it knows that all have landed");

  // The server goes, and another comes in its place: pages find it by themselves.
  server.kill("SIGINT");
  await server.gone;
  await until(async () => /gone|no answer/.test(await text("#phase")), "the page says that the server is gone");
  await serve(port);
  await until(async () => (await text("#phase")) === "live" && (await text("#phase", other)) === "live", "both pages have found the new server");
  assert.equal(await cells(other), whole);
  await shot("again");

  // It was not there when the mission was flown; its slider begins where the node's memory does.
  const ends = (on) => on.locator("#time").evaluate((e) => [Number(e.min), Number(e.max)]);
  await until(async () => { const [first, last] = await ends(page); return first < last / 2; }, "the slider begins with the mission");
  await page.locator("#time").focus();
  await page.keyboard.press("Home");
  await until(async () => (await text("#phase")) === "as it was" && (await cells()) < whole / 2, "the map as it began");
  await page.keyboard.press("Escape");
  await page.locator("#map").focus();
  await until(async () => { await page.keyboard.press("]"); return (await cells()) > 0; }, "and a little later");
  assert.ok((await cells()) < whole);
  assert.doesNotMatch(await text("#legend"), /grey mud/, "nobody had said that then");
  await page.locator("#now").click();
  await until(async () => (await cells()) === whole, "now again");
  assert.match(await text("#events"), /R00 joined/);
  await shot("remembered");
  assert.deepEqual(problems, []);
  console.log("the live page works");
} catch (error) {
  console.error(error);
  process.exitCode = 1;
} finally {
  await browser?.close();
  laptop?.process().kill("SIGKILL");
  for (const child of started) if (child.exitCode === null && child.signalCode === null) child.kill("SIGKILL");
  await Promise.all(started.map((child) => child.gone));
  rmSync(top, { recursive: true });
  process.exit(); // whatever lines are open
}
