// SPDX-License-Identifier: BSD-3-Clause
import { ask, askBytes, decide, hangUp, hasToken, takeToken } from "./api";
import type { CellHistory, Happening, Holding, Label, Mission, Node, Picture, Place, Status, Track, Traffic, TruthClass, Why } from "./api";
import { alarmCss, classColor, LEAST_SURPRISE, MOST_SURPRISE, rampCss, robotColor, USUAL } from "./colors";
import { area, byId, el, pressable, refill, seconds } from "./dom";
import { openExports } from "./exports";
import { drawLink, rateText } from "./link_plot";
import { isSilent, LAYERS, MapView, type Cell, type Layer } from "./map_view";
import { Pictures } from "./pictures";
import { closer } from "./sharper";
import { Pinch } from "./pinch";
import { decodeTiles } from "./tiles";
import type { View3D } from "./view3d";

takeToken();
const map = new MapView(byId<HTMLCanvasElement>("map"));
let held: string | null = null; // the node whose map is looked at; null: all that was heard
const isNow = (): boolean => past === null && held === null;
// What is looked at, for questions that know of moments and of nodes.
const view = (first = "?"): string => {
  const parts = [...(past === null ? [] : [`at=${past}`]), ...(held === null ? [] : [`node=${encodeURIComponent(held)}`])];
  return parts.length ? first + parts.join("&") : "";
};
let mission: Mission | null = null, status: Status | null = null;
let labels: Label[] = [], traffic: Traffic | null = null, events: Happening[] = [];
let past: number | null = null; // mission time that is looked at; null: the newest
let linking: number | null = null; // the label that waits for another to be linked with
let fitted = false, playing = 0,
    followed = false, // all of the map is kept in sight, until somebody moves it
    showRare = false;
let classes: TruthClass[] = [], truthOf = ""; // what the truth was fetched for
const pictures = new Pictures();
const updates: { at: number; bytes: number; fetchMs: number }[] = []; // the last ones, for measuring
const HINT = matchMedia("(hover: none)").matches ? "Tap: what is here, and why · drag: move · two fingers: zoom" : byId("readout").textContent!;
byId("readout").textContent = HINT;
let depth: View3D | null = null; // the view in 3-D, while it is shown
const LAYER_TEXT: Record<Layer, string> = { label: "Label", certainty: "Certainty", surprise: "Surprise", age: "Age", robot: "Robot", coverage: "Coverage", truth: "Truth" };

const LIBRARY = "R9999"; // tells what missions before have named
const nameOf = (label: number): string => labels.find((l) => l.label === label)?.name || String(label);
const colorOf = (label: number): string => labels.find((l) => l.label === label)?.color ?? "#999";
const mayWrite = (): boolean => held === null && mission !== null && !mission.read_only && hasToken();

// ---------- what is fetched

// Cells and robots are asked for with every piece of news; the rest, which is for reading, once a second.
const READ_MS = 1000;
type What = "map" | "all";
let fetching = false, fetchingSince = 0, again: What | null = null, nextAll = 0, allLater = 0;
async function refresh(what: What = "all"): Promise<void> {
  if (fetching) { again = again === "all" ? "all" : what; return; }
  fetching = true; fetchingSince = Date.now();
  if (!isNow() || !mission || performance.now() >= nextAll) what = "all";
  try {
    if (what === "all") {
      clearTimeout(allLater); allLater = 0;
      nextAll = performance.now() + READ_MS;
      mission = await ask<Mission>("/api/mission");
    } else if (!allLater) allLater = window.setTimeout(() => { allLater = 0; void refresh(); }, Math.max(0, nextAll - performance.now()));
    const at = view(), shown = at;
    if (mission!.sequence > 0) {
      const begun = performance.now();
      const [bytes, newStatus] = await Promise.all([askMap(at), ask<Status>("/api/status" + at), what === "all" ? askToRead(at) : null]);
      if (shown !== view()) return; // it has been turned to something else meanwhile
      status = newStatus;
      map.nodes = status.nodes; map.tracksUntil = past ?? Infinity;
      if (bytes) map.take(decodeTiles(bytes)); else map.draw();
      updates.push({ at: performance.now(), bytes: bytes?.byteLength ?? 0, fetchMs: performance.now() - begun });
      if (updates.length > 1000) updates.splice(0, 500);
      if (map.layer === "truth") void fetchTruth();
      if (map.layer === "surprise" && what === "all") void fetchStrangest();
      if (!isNow()) map.sequence = 0, map.life = ""; // the next newest map comes whole
      if (!fitted && !map.isEmpty) { fitted = true; followed = !restoreView(); }
      if (followed && !map.isEmpty) fitAll();
    }
    if (what === "all") show(); else { showCounts(); showTime(); }
  } catch (problem) {
    if (held !== null && (problem as Error).message.startsWith("nothing was heard")) return toast((problem as Error).message);
    byId("phase").textContent = "no answer"; byId("phase").className = "bad";
    byId("phase").title = String(problem);
  } finally {
    fetching = false;
    const next = again;
    again = null;
    if (next) void refresh(next);
  }
}

// Null: the page has it already.
async function askMap(at: string): Promise<ArrayBuffer | null> {
  const knows = isNow() && map.life === mission!.life && map.sequence > 0;
  if (knows && map.sequence === mission!.sequence) return null;
  return askBytes("/api/map?cells=all" + at.replace("?", "&") + (knows ? `&since=${map.sequence}&life=${map.life}` : ""));
}

async function askToRead(at: string): Promise<void> {
  const [newLabels, tracks, newTraffic, happened] = await Promise.all([ask<{ labels: Label[] }>("/api/labels" + at),
    ask<{ tracks: Track[] }>("/api/tracks"), ask<Traffic>("/api/traffic"), ask<{ events: Happening[] }>("/api/events")]);
  traffic = newTraffic; events = happened.events;
  labels = newLabels.labels.sort((a, b) => b.area_m2 - a.area_m2);
  map.tracks = tracks.tracks;
  map.setLabels(labels);
  const pictured = !isNow() ? at : `${mission!.life} ${mission!.pictures}`;
  if (pictures.of !== pictured) pictures.take(pictured, (await ask<{ labels: { label: number; pictures: Picture[] }[] }>("/api/pictures" + at)).labels, at.replace("?", "&"));
}

// The truth is worked out when it is first asked for, which may take a while.
async function fetchTruth(): Promise<void> {
  if (!mission?.truth) return;
  const at = view(), wanted = `${mission.life} ${at} ${past === null ? mission.sequence : ""}`;
  if (truthOf === wanted) return;
  truthOf = wanted;
  try {
    classes = (await ask<{ classes: TruthClass[] }>("/api/classes")).classes;
    map.setTruth(decodeTiles(await askBytes("/api/truth" + at)), classes);
    showRamp();
  } catch (problem) {
    truthOf = "";
    const waits = (problem as Error).message.includes("being found out");
    if (!waits) toast((problem as Error).message);
    if (waits) setTimeout(() => { if (map.layer === "truth") void fetchTruth(); }, 1000);
  }
}

// The server says something every ten seconds. When it does not, the line is dead and nobody has told this end: a
// cable that was pulled. A look that comes much later than it was due says that the machine slept, and its lines are
// not waited for; but no browser is on time for a page that nobody sees.
const DEAD_MS = 25000, HUNG_MS = 60000, LOOK_MS = 2000, LATE_MS = 5000;
function listen(): void {
  const stream = new EventSource("/api/stream");
  let heard = Date.now(), due = heard + LOOK_MS, wasHidden = document.hidden;
  const watch = setInterval(() => {
    const now = Date.now(), slept = now > due + LATE_MS && !wasHidden && !document.hidden;
    due = now + LOOK_MS; wasHidden = document.hidden;
    if (fetching && now > fetchingSince + HUNG_MS) hangUp();
    if (!slept && now < heard + DEAD_MS) return;
    clearInterval(watch); stream.close();
    hangUp(); listen();
  }, LOOK_MS);
  stream.addEventListener("ping", () => (heard = Date.now()));
  stream.onmessage = (message) => {
    heard = Date.now();
    const news = JSON.parse(message.data);
    const isNews = !mission || news.life !== mission.life || news.phase !== mission.phase || byId("phase").className === "bad";
    if (!isNow() && !isNews) return;
    if (mission && !isNews) Object.assign(mission, { sequence: news.sequence, pictures: news.pictures, time_s: news.time_s });
    void refresh(isNews ? "all" : "map");
  };
  stream.onerror = () => {
    byId("phase").textContent = "server gone, trying again"; byId("phase").className = "bad";
    if (stream.readyState === EventSource.CLOSED) { clearInterval(watch); setTimeout(listen, 2000); } // refused: others listen
  };
}
setInterval(() => { if (held !== null && past === null && mission?.phase === "live" && !document.hidden) void refresh(); }, 5000);
document.addEventListener("visibilitychange", () => { if (!document.hidden) void refresh(); });

// ---------- what is shown

function show(): void {
  if (!mission) return;
  const phase = byId("phase");
  const words: Record<string, string> = { live: "live", whole: mission.source === "run" ? "finished run" : "recording", reading: "reading the recording…", lost: "node not answering" };
  phase.textContent = held !== null ? `as ${held} ${past === null && mission.phase === "live" ? "holds" : "held"} it` : past === null ? words[mission.phase] : "as it was"; phase.title = mission.problem;
  phase.className = mission.phase === "lost" ? "bad" : !isNow() ? "past" : mission.phase === "live" ? "good" : "";
  byId("mission").textContent = status ? `mission ${status.mission_id}` : "";
  byId("mission").title = `${mission.place} · console ${mission.version}`;
  showCounts();
  byId("empty").hidden = !map.isEmpty;
  byId("undo").hidden = !mayWrite();
  document.querySelector<HTMLElement>("#layers [data-layer=truth]")!.hidden = !mission.truth;
  showHolders(); void showHolding();
  showLegend(); showRobots(); showLink(); showEvents(); showTime(); showRamp();
}

// Whose map it may be: of what is recorded, or remembered.
function showHolders(): void {
  const box = byId<HTMLSelectElement>("holders");
  byId("holder").hidden = !(mission!.source === "node" || mission!.times_s.length > 1) || !status;
  const names = ["", ...(status?.nodes.map((n) => n.name) ?? [])];
  if (held !== null && !names.includes(held)) names.push(held);
  if ([...box.options].map((o) => o.value).join() !== names.join()) box.replaceChildren(...names.map((name) => el("option", { value: name }, name || "whoever heard all")));
  box.value = held ?? "";
}

// What it held of whom, and how sure that is.
async function showHolding(): Promise<void> {
  const box = byId("holding");
  box.hidden = held === null;
  if (held === null) return;
  try {
    const of = view(), h = await ask<Holding>("/api/holding" + of);
    if (of !== view()) return;
    const others = h.shares.filter((s) => s.robot !== h.node && s.robot.startsWith("R")), whole = others.filter((s) => s.whole).length, late = others.filter((s) => !s.whole);
    box.textContent = !h.fuses ? `${h.node} fuses nothing: it holds its own cells and topics, as told by ${seconds(h.at_s)}.`
      : `${h.node} at ${seconds(h.at_s)}: ` + [whole > 0 ? `all that ${whole} of ${others.length} robots had said` : "", ...late.map((s) => `of ${s.robot} what it said until ${seconds(s.until_s)}${s.certain ? "" : " at least"}`)].filter((part) => part !== "").join("; ") + "."
        + (h.agrees === true ? " Its own digest says the same." : h.agrees === false ? " Its own digest says OTHERWISE." : "");
  } catch (problem) { box.textContent = (problem as Error).message; }
}

function showCounts(): void {
  byId("counts").textContent = status ? `${status.cells.toLocaleString("en")} cells · ${labels.length} labels · ${area(labels.reduce((s, l) => s + l.area_m2, 0))}` : "";
}

// Known from a mission before.
const libraryMark = (l: Label): HTMLElement | null => l.library?.length ? el("span", { class: "library", title: `The library of missions before knows it as ${l.library.map((n) => `“${n}”`).join(", ")}` }, "library") : null;

function showLegend(): void {
  if (document.activeElement?.closest("#legend input")) return; // somebody is typing a name
  const total = labels.reduce((s, l) => s + l.area_m2, 0) || 1;
  const isRare = (l: Label): boolean => l.area_m2 < total / 500 && l.name === "" && map.selected !== l.label;
  const rare = labels.filter(isRare);
  const row = (l: Label): HTMLElement => el("div", {
    ...pressable(() => choose(l.label)), class: "row label" + (map.selected === l.label ? " chosen" : ""), "data-key": `label ${l.label}`, title: `label ${l.label}, ${l.cells} cells`,
    "aria-pressed": String(map.selected === l.label), dblclick: () => nameLabel(l.label),
  },
    el("span", { class: "swatch", style: `background:${l.color}` }),
    el("span", { class: "examples" }, ...pictures.ofLabel(l.label).slice(0, 2).map((p) => pictures.image("legend", p))),
    el("span", { class: "what" }, el("span", { class: "titled" }, el("span", { class: "name", "data-label": String(l.label) }, l.name || `label ${l.label}`), libraryMark(l)),
      el("small", { class: "dim" }, `${area(l.area_m2)} · ${l.robots.length === 1 ? "only " + l.robots[0] : `${l.robots.length} robots`}`)),
    el("span", { class: "bar" }, el("i", { style: `width:${(100 * l.area_m2) / total}%;background:${l.color}` })),
    el("span", { class: "number dim" }, `${((100 * l.area_m2) / total).toFixed(l.area_m2 * 100 < total ? 1 : 0)} %`));
  const fold = rare.length === 0 ? [] : [el("button", { class: "small rare", "data-key": "rare", "aria-expanded": String(showRare), click: () => { showRare = !showRare; showLegend(); } },
    showRare ? "hide the rare ones" : `+ ${rare.length} rare ${rare.length === 1 ? "label" : "labels"}, ${area(rare.reduce((s, l) => s + l.area_m2, 0))} together`)];
  refill(byId("legend"), ...labels.filter((l) => showRare || !isRare(l)).map(row), ...fold);
}

function showRobots(): void {
  if (!status) return;
  const newest = Math.max(...status.nodes.map((n) => n.heard_s), 0);
  const state = (n: Node): [string, string] => n.agreement === "other" ? ["other map!", "bad"] : isSilent(n, newest) ? [`silent since ${seconds(n.heard_s)}`, "bad"]
    : n.phase === "node" ? ["node", ""] : n.phase !== "flying" ? [n.heard_whole || mission!.source !== "node" ? "landed" : "landed, part missing", ""] : ["flying", "good"];
  refill(byId("robots"), ...status.nodes.map((n) => {
    const number = n.name.startsWith("R") ? Number(n.name.slice(1)) : null;
    const [text, kind] = state(n);
    const used = n.budget > 0 && n.heard_s > 0 ? n.bytes_sent / (n.budget * n.heard_s) : 0;
    const press = (): void => { map.onlyRobot = map.onlyRobot === number ? null : number; map.repaint(); show(); remember(); };
    return el("div", { ...(number === null ? {} : { ...pressable(press), "aria-pressed": String(map.onlyRobot === number) }), class: "row robot" + (number !== null && map.onlyRobot === number ? " chosen" : ""),
                       "data-key": n.name, title: number === null ? n.name : "Click: only what this robot saw last" },
      el("span", { class: "dot", style: `background:${number === null ? "#1d2733" : kind === "bad" ? "#8a8f96" : robotColor(number)}` }),
      el("span", { class: "name" }, n.name), el("span", { class: "state " + kind }, text),
      el("span", { class: "number dim" }, number === null ? "" : `${n.observation + 1}${n.num_observations ? "/" + n.num_observations : ""}`),
      el("span", { class: "number", title: `${n.bytes_sent} bytes sent, ${n.queue_bytes} waiting` }, n.budget > 0 ? `${(100 * used).toFixed(0)} % of ${rateText(n.budget)}` : `${(n.bytes_sent / 1000).toFixed(1)} kB`),
      number !== null && mayWrite() && past === null ? el("button", { class: "small", "data-key": "exclude " + n.name, title: "Make the map as if it had never been there", click: (e) => { e.stopPropagation(); if (confirm(`Make the map as if ${n.name} had never been there? Undo brings it back.`)) void decided({ edit: "exclude", robot: n.name }); } }, "exclude") : null);
  }));
}

function showLink(): void {
  if (!traffic) return;
  const only = map.onlyRobot === null ? null : status?.nodes.find((n) => n.name.startsWith("R") && Number(n.name.slice(1)) === map.onlyRobot)?.name ?? null;
  byId("linkwhat").textContent = only ? `bytes/s, ${only}` : "bytes/s, everybody together";
  drawLink(byId<HTMLCanvasElement>("link"), traffic, only, past ?? Infinity);
  byId("linkkey").replaceChildren(...traffic.classes.map((name) => el("span", {}, el("i", { style: `background:${classColor(name)}` }), name)));
}

function showEvents(): void {
  const until = past ?? Infinity;
  refill(byId("events"), ...events.filter((e) => e.time_s <= until).slice(-200).reverse().map((e) =>
    el("div", { ...pressable(() => travel(e.time_s)), class: "row event " + e.kind, "data-key": `${e.time_s} ${e.text}`, title: "Click: the map at that time" }, el("span", { class: "dim when" }, seconds(e.time_s)), el("span", {}, e.text))));
}

function showTime(): void {
  const times = mission!.times_s, slider = byId<HTMLInputElement>("time");
  const some = times.length > 1;
  slider.disabled = !some; byId<HTMLButtonElement>("play").disabled = !some;
  slider.min = String(times[0] ?? 0); slider.max = String(times[times.length - 1] ?? 1);
  if (past === null && mission!.time_s > Number(slider.max)) slider.max = String(mission!.time_s);
  if (document.activeElement !== slider || past === null) slider.value = String(past ?? slider.max);
  byId("clock").textContent = some ? `${seconds(past ?? mission!.time_s)} of ${seconds(mission!.time_s)}` : mission!.phase === "whole" ? "no recording: only the end is known" : seconds(mission!.time_s);
  byId("now").hidden = past === null;
}

function showRamp(): void {
  const box = byId("ramp");
  box.hidden = !["certainty", "surprise", "age", "truth"].includes(map.layer);
  if (box.hidden) return;
  if (map.layer === "truth") {
    box.replaceChildren(...(classes.length ? classes.map((c) => el("span", { class: "class" }, el("b", { class: "swatch", style: `background:${c.color}` }), c.name)) : ["the truth is being worked out…"]));
    return;
  }
  if (map.layer === "surprise") {
    box.title = "Beside all that its robot had met: 1 is what one cell in ten exceeds";
    box.replaceChildren(el("span", { class: "class" }, el("b", { class: "swatch", style: `background:${USUAL}` }), "as usual"),
      el("span", {}, `surprised: ${LEAST_SURPRISE}`), el("i", { style: `background:${alarmCss}` }), el("span", {}, `${MOST_SURPRISE} and more`),
      el("div", { class: "places" }, ...(strangest.length ? ["strangest: "] : []), ...strangest.map((p) => el("button", { class: "small", title: `${area(p.area_m2)} that ${p.robots.join(", ")} saw first at ${seconds(p.first_seen_s)}; labelled ${p.name || p.label}`, click: () => goTo(p) }, p.surprise.toFixed(1)))));
    return;
  }
  box.title = "";
  const [low, high] = map.layer === "certainty" ? ["unsure", "sure"] : [`${seconds(map.ageRange()[1])} ago`, "just seen"];
  box.replaceChildren(el("span", {}, low), el("i", { style: `background:${rampCss}` }), el("span", {}, high));
}

function setLayer(layer: Layer): void {
  map.layer = layer;
  for (const button of byId("layers").children) button.setAttribute("aria-checked", String((button as HTMLElement).dataset.layer === layer));
  map.repaint(); showRamp(); remember();
  if (layer === "truth") void fetchTruth();
  if (layer === "surprise") void fetchStrangest();
}

// The places that surprised most: asked for when they are looked at, not more often than every five seconds.
let strangest: Place[] = [], strangestAt = -Infinity, strangestOf = "";
async function fetchStrangest(): Promise<void> {
  const of = `${mission?.life} ${mission?.sequence}`;
  if (!isNow()) { strangest = []; return showRamp(); }
  if (of === strangestOf || performance.now() < strangestAt + 5000) return;
  [strangestAt, strangestOf] = [performance.now(), of];
  try { strangest = (await ask<{ places: Place[] }>("/api/surprises?least=2")).places.slice(0, 8); } catch { strangest = []; }
  showRamp();
}
function goTo(p: Place): void {
  followed = false;
  if (depth) { depth.target.set(p.x_m, p.y_m, p.z_m); depth.distance = Math.min(depth.distance, 60 * map.cellSize); } else { map.center = { x: p.x_m, y: p.y_m }; map.scale = Math.max(map.scale, 12 / map.cellSize); }
  map.draw();
  void inspectCell(map.cellAt(p.x_m, p.y_m, p.z_m));
  if (!depth) { map.center.x += map.covered / 2 / map.scale; map.draw(); }
}

// ---------- asking and deciding

function toast(text: string, undo = false): void {
  const box = byId("toast");
  box.replaceChildren(text, ...(undo ? [" ", el("button", { click: () => void takeBack() }, "Undo")] : []));
  box.hidden = false;
  clearTimeout(Number(box.dataset.timer));
  box.dataset.timer = String(setTimeout(() => (box.hidden = true), 8000));
}

const saidHere = new Map<string, string>(); // what was decided on this page, by id; the events tell of it later, and of all others
async function decided(edit: Record<string, string>): Promise<void> {
  try {
    const { id, says } = await decide(edit), undone = says.match(/^(\S+) is undone$/)?.[1];
    saidHere.set(id, says);
    const was = undone && (saidHere.get(undone) ?? events.find((e) => e.text.startsWith(undone + ": "))?.text.slice(undone.length + 2));
    toast(was ? "Undone: " + was : says, edit.edit !== "undo");
    await refresh();
    if (edit.edit === "undo" && map.selected !== null) void inspect(map.selected);
  } catch (problem) { toast((problem as Error).message); }
}
const takeBack = (): Promise<void> => decided({ edit: "undo" });

function choose(label: number | null): void {
  if (linking !== null && label !== null && label !== linking) {
    const first = linking;
    linking = null;
    byId("map").classList.remove("linking");
    void decided({ edit: "link", a: String(first), b: String(label) }).then(() => choose(first));
    return;
  }
  map.selected = label;
  if (label === null) { byId("inspector").hidden = true; map.covered = 0; } else void inspect(label);
  map.repaint(); show(); remember();
}

function linkNext(label: number): void {
  if (!mayWrite() || past !== null) return;
  linking = label;
  byId("map").classList.add("linking");
  toast(`Now choose the label that is the same as ${nameOf(label)}; Esc: none.`);
}

// The picture that is looked at closely, under the others; pressed again it goes.
function look(p: Picture, by: HTMLElement): void {
  const box = byId("inspector"), open = box.querySelector(".closer"), was = by.getAttribute("aria-expanded") === "true";
  for (const other of box.querySelectorAll(".look")) other.setAttribute("aria-expanded", "false");
  open?.remove();
  if (was) return;
  by.setAttribute("aria-expanded", "true");
  const isLive = mission!.source === "node" && mission!.phase === "live" && past === null;
  by.parentElement!.after(closer(pictures, p, isLive, mayWrite()));
}

async function inspect(label: number, cell?: HTMLElement): Promise<void> {
  const box = byId("inspector"), l = labels.find((x) => x.label === label);
  box.hidden = false;
  map.covered = map.canvas.clientWidth > 760 ? box.offsetWidth + 24 : 0;
  const buttons = el("div", { class: "buttons" });
  if (mayWrite() && past === null) buttons.append(
    el("button", { click: () => nameLabel(label) }, l?.name ? "Rename" : "Name"),
    el("button", { title: "Say that another label is the same: choose it next (l)", click: () => linkNext(label) }, "Same as…"));
  buttons.append(el("a", { href: `/api/area?label=${label}&format=geojson`, download: `label${label}.geojson`, class: "button" }, "Patches"));
  const why = el("div", { class: "why dim" }, "asking why…");
  box.replaceChildren(el("div", { class: "head" }, el("span", { class: "swatch big", style: `background:${colorOf(label)}` }), el("b", {}, l?.name || `label ${label}`),
    el("span", { class: "dim" }, l?.name ? `label ${label}` : ""), l ? libraryMark(l) : null, el("span", { class: "grow" }), el("button", { class: "small", "aria-label": "Close", click: () => choose(null) }, "×")),
    l ? el("div", { class: "dim" }, `${area(l.area_m2)}, first seen ${seconds(l.first_seen_s)}, last ${seconds(l.last_seen_s)}, ${(100 * l.certainty).toFixed(0)} % sure in the mean`) : "",
    el("div", { class: "strip" }, ...pictures.ofLabel(label).slice(0, 8).map((p) => el("button", { class: "look", "aria-expanded": "false", title: "Closer, and what a sharper one costs", click: (e) => look(p, e.currentTarget as HTMLElement) }, pictures.image("inspector", p)))), cell ?? "", buttons, why);
  try {
    const w = await ask<Why>(`/api/why?label=${label}`);
    if (map.selected === label) why.replaceWith(whyTable(w));
  } catch (problem) { why.textContent = (problem as Error).message; }
}

// Says that one of its things is something else: all but the one that the label is named after.
function apart(w: Why, robot: string, topic: number): HTMLElement | null {
  const number = Number(robot.slice(1)) * 10000 + topic;
  if (!mayWrite() || past !== null || robot === LIBRARY || number === w.label) return null;
  return el("button", { class: "small", title: "This is something else: take it out of the label", "aria-label": `${robot} topic ${topic} is something else`, click: () => void decided({ edit: "unlink", a: String(w.label), b: String(number) }).then(() => { if (map.selected === w.label) void inspect(w.label); }) }, "other");
}

function whyTable(w: Why): HTMLElement {
  const percent = (s: number | null): string => (s === null ? "–" : s.toFixed(2));
  const bar = (s: number | null, color: string): HTMLElement => el("span", { class: "sim" }, el("i", { style: `width:${44 * Math.max(0, s ?? 0)}px;background:${color}` }), percent(s));
  const robots = new Set(w.members.map((m) => m.robot).filter((robot) => robot !== LIBRARY)).size, takes = w.sigma === null ? "" : ` From ${w.sigma.toFixed(2)} on things count as the same, 1 is equal.`;
  const sentence = w.members.length === 1 ? `Only ${w.members[0].robot} knows it: nobody else told of anything enough like it.${takes}`
    : `${robots === 1 ? "One robot" : `${robots} robots`} told of ${w.members.length} things that look alike.${takes}`;
  const kinds = w.shared_words.filter((g) => g.words.some((word) => word.members === w.members.length)).length;
  const face = (slot: string, robot: string, topic: number): HTMLElement => { const p = pictures.ofTopic(robot, topic)[0]; return p ? pictures.image(slot, p) : el("span", { class: "nopicture", title: "no picture has come yet" }); };
  const other = w.nearest_label, otherPictures = other ? pictures.ofLabel(other.label).slice(0, 4).map((p) => pictures.image("other", p)) : [];
  return el("div", { class: "why" }, el("h3", {}, "Why are these the same?"), el("p", {}, sentence),
    el("table", {}, el("tr", {}, el("th", { colspan: "2" }, "seen by"), el("th", { title: "mean similarity to the others of this label, 0 to 1" }, "like these"), el("th", { colspan: "2", title: "the thing outside this label that is most like it" }, "most like it outside")),
      ...w.members.map((m) => el("tr", {}, el("td", { class: "face" }, face("member", m.robot, m.topic)),
        el("td", {}, el("span", { class: "dot", style: `background:${m.robot === LIBRARY ? "#1d2733" : robotColor(Number(m.robot.slice(1)))}` }), m.robot === LIBRARY ? "library" : m.robot,
          el("small", { class: "dim" }, m.robot === LIBRARY ? " of missions before" : ` topic ${m.topic}, ${m.cells} cells`), apart(w, m.robot, m.topic)),
        el("td", {}, bar(m.mean_similarity, "#0072b2")),
        el("td", { class: "face" }, m.outsider ? face(`outsider of ${m.robot}/${m.topic}`, m.outsider.robot, m.outsider.topic) : ""),
        el("td", {}, m.outsider ? bar(m.outsider.similarity, "#e69f00") : "–")))),
    kinds > 0 && w.members.length > 1 ? el("p", {}, `In ${kinds} of ${w.shared_words.length} kinds of visual words all of them hold the same ones.`) : null,
    other ? el("p", { class: "other" }, "Not the same, but nearest: ", el("a", { href: "#", click: (e) => { e.preventDefault(); choose(other.label); } }, el("span", { class: "swatch", style: `background:${colorOf(other.label)}` }), nameOf(other.label)),
      ` (${other.mean_similarity.toFixed(2)}${w.margin === null ? "" : `, ${Math.abs(w.margin).toFixed(2)} ${w.margin >= 0 ? "short of" : "beyond"} joining`})`, el("span", { class: "strip" }, ...otherPictures)) : null,
    el("p", { class: "dim" }, `Matched by ${w.matcher}, ${w.similarity}.${w.matcher === "shoal" ? " Groups are joined by the mean of all pairs, so single things outside may be more alike than the ones inside." : ""}`));
}

async function inspectCell(cell: Cell | null): Promise<void> {
  if (!cell) return choose(null);
  if (linking !== null) return choose(cell.label);
  map.selected = cell.label; map.repaint(); show(); remember();
  const list = el("div", { class: "cell" }, el("code", {}, `${cell.x.toFixed(2)} ${cell.y.toFixed(2)}`), depth ? ` m, ${cell.z.toFixed(2)} m high: ` : " m: ", `R${String(cell.robot).padStart(2, "0")} saw it last at ${seconds(cell.seen)}, ${(100 * cell.certainty).toFixed(0)} % sure` + (cell.surprise > 0 ? `; it surprised: ${cell.surprise.toFixed(1)} (1 is what one cell in ten exceeds)` : ""));
  void inspect(cell.label, list);
  try {
    const answer = await ask<CellHistory>(`/api/at?x=${cell.x}&y=${cell.y}`);
    const history = answer.cells.reduce((best, c) => Math.abs(c.z_m - cell.z) < Math.abs(best.z_m - cell.z) ? c : best).history; // empty: reduce throws
    if (history.length > 1) list.append(el("ul", {}, ...history.map((h) => el("li", {}, `${h.robot} at ${seconds(h.seen_s)}: ${nameOf(h.label)}`))));
  } catch { /* the cell's own line stands */ }
}

function nameLabel(label: number): void {
  if (!mayWrite()) return toast(mission?.read_only ? "This console is read-only." : "Open the URL that serve printed to name things.");
  const place = document.querySelector(`#legend [data-label="${label}"]`);
  if (!place) return;
  const input = el("input", { value: labels.find((l) => l.label === label)?.name ?? "", maxlength: "64", "aria-label": "Name" }) as HTMLInputElement;
  const box = el("span", { class: "naming" }, input, el("small", { class: "dim" }, "Enter keeps it, Esc does not"));
  const done = (keep: boolean): void => { const text = input.value.trim(); box.replaceWith(place); if (keep) void decided({ edit: "name", label: String(label), text }).then(() => { if (map.selected === label) void inspect(label); }); };
  input.addEventListener("keydown", (e) => { e.stopPropagation(); if (e.key === "Enter") done(true); if (e.key === "Escape") done(false); });
  input.addEventListener("click", (e) => e.stopPropagation());
  place.replaceWith(box);
  input.focus(); input.select();
}

// ---------- time

let travelling = 0;
function travel(time: number | null): void {
  past = time === null || (mission && time >= mission.times_s[mission.times_s.length - 1]) ? null : time;
  clearTimeout(travelling);
  travelling = window.setTimeout(() => { void refresh(); remember(); }, 60);
  if (mission) showTime();
}
function step(by: number): void {
  if (!mission || mission.times_s.length < 2) return;
  const times = mission.times_s, at = past ?? times[times.length - 1];
  let i = times.length - 1;
  while (i > 0 && times[i] > at) --i;
  travel(times[Math.max(0, Math.min(times.length - 1, i + by))]);
}
function play(): void {
  const stop = (): void => { clearInterval(playing); playing = 0; byId("play").textContent = "▶"; };
  if (playing) return stop();
  if (past === null && mission) travel(mission.times_s[0]);
  byId("play").textContent = "❚❚";
  playing = window.setInterval(() => { step(1); if (past === null) stop(); }, 600);
}

// ---------- in 3-D

let view3d: Promise<View3D> | null = null;
function openDepth(): Promise<View3D> {
  const file = "/view3d.js"; // fetched when it is first wanted
  return (view3d ??= (import(file) as Promise<typeof import("./view3d")>).then((module) => new module.View3D(byId<HTMLCanvasElement>("depth"), map)));
}
async function setDepth(on: boolean, camera: number[] | null = null): Promise<void> {
  if (on === (depth !== null)) return;
  if (on) {
    try { depth = await openDepth(); } catch { view3d = null; return toast("This browser cannot draw in 3-D."); }
    map.depth = depth;
    depth.forget(); // the map may be another since it was left
    for (const key of map.tiles.keys()) depth.soil(key);
    depth.look(map.center, map.scale);
    if (camera) [depth.azimuth, depth.elevation, depth.distance, depth.target.z] = camera;
    if (followed) fitAll();
  } else {
    map.center = { x: depth!.target.x, y: depth!.target.y }; map.scale = Math.max(0.02, Math.min(400, depth!.scale()));
    map.depth = depth = null;
    if (followed) fitAll();
  }
  byId("depth").hidden = !on;
  byId("threed").setAttribute("aria-pressed", String(on));
  byId("map").classList.toggle("turns", on);
  byId("readout").textContent = on ? "Click: what is here, and why · drag: turn · right or Shift and drag: move · wheel: zoom" : HINT;
  map.repaint(); remember();
}
const fitAll = (): void => { if (depth) { depth.fit(map.covered); map.draw(); } else map.fit(); };
const panBy = (px: number, py: number): void => { if (depth) { depth.pan(px, py); map.draw(); } else map.pan(px, py); };
const zoomBy = (factor: number, px?: number, py?: number): void => { if (depth) { depth.zoom(factor); map.draw(); } else map.zoom(factor, px, py); };
const orbitBy = (px: number, py: number): void => { depth?.orbit(px, py); map.draw(); };
const cellUnder = (px: number, py: number): Cell | null => depth ? depth.pick(px, py) : map.cellAt(...map.toWorld(px, py));

// ---------- a link to any view

function remember(): void {
  const center = depth ? depth.target : map.center;
  const hash = new URLSearchParams({ x: center.x.toFixed(2), y: center.y.toFixed(2), zoom: (depth ? depth.scale() : map.scale).toPrecision(4), layer: map.layer });
  if (depth) hash.set("camera", [depth.azimuth.toFixed(1), depth.elevation.toFixed(1), depth.distance.toPrecision(5), depth.target.z.toFixed(2)].join(" "));
  if (past !== null) hash.set("t", past.toFixed(3));
  if (held !== null) hash.set("node", held);
  if (map.selected !== null) hash.set("label", String(map.selected));
  const hidden = [map.showTracks ? "" : "tracks", map.showRobots ? "" : "robots"].filter((s) => s !== "").join(" ");
  if (hidden) hash.set("without", hidden);
  if (map.onlyRobot !== null) hash.set("robot", String(map.onlyRobot));
  history.replaceState(null, "", "#" + hash.toString());
}
function restoreView(): boolean {
  const hash = new URLSearchParams(location.hash.slice(1));
  const number = (key: string): number | null => { const v = hash.get(key); return v === null || !Number.isFinite(Number(v)) ? null : Number(v); };
  const layer = hash.get("layer") as Layer;
  if (LAYERS.includes(layer)) setLayer(layer);
  map.selected = number("label"); map.onlyRobot = number("robot");
  const hidden = (hash.get("without") ?? "").split(" ");
  byId<HTMLInputElement>("tracks").checked = map.showTracks = !hidden.includes("tracks");
  byId<HTMLInputElement>("names").checked = map.showRobots = !hidden.includes("robots");
  if (map.selected !== null) void inspect(map.selected);
  const [x, y, zoom, t] = [number("x"), number("y"), number("zoom"), number("t")];
  held = hash.get("node");
  if (t !== null) travel(t); else if (held !== null) setTimeout(() => void refresh());
  if (map.selected !== null || map.onlyRobot !== null) map.repaint();
  if (x === null || y === null || zoom === null || zoom <= 0) return false;
  map.center = { x, y }; map.scale = Math.max(0.02, Math.min(400, zoom)); map.draw();
  const camera = (hash.get("camera") ?? "").split(" ").map(Number);
  if (camera.length === 4 && camera.every(Number.isFinite) && camera[2] > 0) { followed = false; void setDepth(true, camera); }
  return true;
}

// ---------- hands

const KEYS: [string, string][] = [["click", "what is here, and why"], ["drag, wheel", "move, zoom"], ["Tab, Enter", "go through everything there is to press, press it"], ["arrows + − 0", "move, zoom, see everything"], ["Enter", "on the map: what is under the cross, and why"], ["d", "in 3-D: drag or Shift and arrows turn, Shift and drag moves"], ["1 … 7", "label, certainty, surprise, age, robot, coverage, truth (when it is known)"],
  ["[ ] space", "earlier, later, play"], ["n", "name the chosen label"], ["l", "it is the same as another one"], ["u", "undo"], ["e", "export"], ["c", "copy a link to what you see"], ["Esc", "choose nothing"], ["?", "these keys"]];

// Where the clipboard is not to be had (a page that is not from this machine, without TLS), the link is shown.
function copyLink(): void {
  remember();
  const show = (): void => toast(location.href);
  if (!navigator.clipboard) return show();
  void navigator.clipboard.writeText(location.href).then(() => toast("The link is copied. It carries no key."), show);
}

function hands(): void {
  const canvas = map.canvas;
  let from: [number, number] | null = null, moved = false, turns = false;
  const pinch = new Pinch(canvas);
  canvas.addEventListener("contextmenu", (e) => { if (depth) e.preventDefault(); });
  canvas.addEventListener("pointerdown", (e) => { from = [e.clientX, e.clientY]; moved = false; turns = depth !== null && e.button === 0 && !e.shiftKey; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener("pointermove", (e) => {
    if (pinch.isOn) {
      const [factor, x, y] = pinch.step();
      from = null; followed = false;
      return zoomBy(factor, x, y);
    }
    if (from) {
      if (Math.abs(e.clientX - from[0]) + Math.abs(e.clientY - from[1]) > 3 || moved) { moved = true; followed = false; (turns ? orbitBy : panBy)(e.clientX - from[0], e.clientY - from[1]); from = [e.clientX, e.clientY]; }
      if (depth) return;
    }
    const cell = cellUnder(e.offsetX, e.offsetY);
    if (depth && !cell) return;
    const [x, y] = depth ? [cell!.x, cell!.y] : map.toWorld(e.offsetX, e.offsetY);
    byId("readout").textContent = `${x.toFixed(1)}, ${y.toFixed(1)}${depth ? `, ${cell!.z.toFixed(1)}` : ""} m` + (cell ? ` · ${nameOf(cell.label)} · R${String(cell.robot).padStart(2, "0")} at ${seconds(cell.seen)} · ${(100 * cell.certainty).toFixed(0)} % sure` + (cell.surprise > 0 ? ` · surprise ${cell.surprise.toFixed(1)}` : "") + (map.layer === "truth" && cell.truth !== null ? ` · truly ${classes.find((c) => c.id === cell.truth)?.name ?? cell.truth}` : "") : "");
  });
  canvas.addEventListener("pointerup", (e) => { if (from && !moved && e.button === 0) void inspectCell(cellUnder(e.offsetX, e.offsetY)); else remember(); from = null; });
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); followed = false; zoomBy(Math.exp(-e.deltaY * 0.0015), e.offsetX, e.offsetY); remember(); }, { passive: false });
  for (const layer of LAYERS) byId("layers").append(el("button", { role: "radio", "data-layer": layer, "aria-checked": String(layer === map.layer), click: () => setLayer(layer) }, LAYER_TEXT[layer]));
  byId("threed").addEventListener("click", () => void setDepth(depth === null));
  byId("fit").addEventListener("click", () => { followed = true; fitAll(); remember(); });
  byId<HTMLInputElement>("tracks").addEventListener("change", (e) => { map.showTracks = (e.target as HTMLInputElement).checked; map.draw(); remember(); });
  byId<HTMLInputElement>("names").addEventListener("change", (e) => { map.showRobots = (e.target as HTMLInputElement).checked; map.draw(); remember(); });
  byId("undo").addEventListener("click", () => void takeBack());
  byId("copy").addEventListener("click", copyLink);
  byId("holders").addEventListener("change", (e) => {
    held = (e.target as HTMLSelectElement).value || null;
    choose(null); map.sequence = 0; map.life = "";
    remember(); void refresh();
  });
  byId("export").addEventListener("click", () => { if (mission) openExports(mission); });
  byId<HTMLInputElement>("time").addEventListener("input", (e) => travel(Number((e.target as HTMLInputElement).value)));
  byId("now").addEventListener("click", () => travel(null));
  byId("play").addEventListener("click", play);
  const keys = byId<HTMLDialogElement>("keys");
  keys.append(el("h2", {}, "Keys"), el("table", {}, ...KEYS.map(([k, what]) => el("tr", {}, el("td", {}, el("kbd", {}, k)), el("td", {}, what)))), el("form", { method: "dialog" }, el("button", {}, "Close")));
  byId("help").addEventListener("click", () => keys.showModal());
  new ResizeObserver(() => { // what lies over the map's top
    map.bar = byId("bar").offsetHeight;
    byId("mapbox").style.setProperty("--bar", `${map.bar}px`);
    if (followed) fitAll();
  }).observe(byId("bar"));
  addEventListener("resize", () => { if (followed) fitAll(); map.draw(); showLink(); });
  for (const event of ["focus", "blur"]) canvas.addEventListener(event, () => { map.showCross = canvas.matches(":focus-visible"); map.draw(); });
  addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || (e.target as HTMLElement).matches("input:not([type=range]):not([type=checkbox]), select")) return;
    const arrow = depth && e.shiftKey ? orbitBy : panBy;
    const act: Record<string, () => void> = {
      ArrowLeft: () => arrow(60, 0), ArrowRight: () => arrow(-60, 0), ArrowUp: () => arrow(0, 60), ArrowDown: () => arrow(0, -60),
      "+": () => zoomBy(1.3), "=": () => zoomBy(1.3), "-": () => zoomBy(1 / 1.3), "0": fitAll, d: () => void setDepth(depth === null), "[": () => step(-1), "]": () => step(1), " ": play,
      n: () => { if (map.selected !== null) nameLabel(map.selected); }, l: () => { if (map.selected !== null) linkNext(map.selected); }, c: copyLink, u: () => { if (mayWrite()) void takeBack(); }, "?": () => keys.showModal(), e: () => { if (mission) openExports(mission); },
      Escape: () => { linking = null; byId("map").classList.remove("linking"); map.onlyRobot = null; choose(null); },
    };
    LAYERS.forEach((layer, i) => (act[String(i + 1)] = () => { if (layer !== "truth" || mission?.truth) setLayer(layer); }));
    if (e.target instanceof HTMLInputElement && e.target.type === "range" && e.key.startsWith("Arrow")) return;
    if ((e.target instanceof HTMLButtonElement || (e.target as HTMLElement).matches("a, input, summary")) && e.key === " ") return;
    if (document.querySelector("dialog[open]")) return;
    if (e.key === "Enter" && e.target === canvas) act.Enter = () => { map.showCross = true; void inspectCell(cellUnder(...map.cross())); };
    const action = act[e.key];
    if (!action) return;
    e.preventDefault(); action();
    if (e.key.startsWith("Arrow") || "+=-".includes(e.key)) followed = false;
    if (e.key === "0") followed = true;
    if (e.key.startsWith("Arrow") || "+=-0".includes(e.key)) remember();
  });
}

(window as unknown as Record<string, unknown>).shoal = { map, updates, get depth() { return depth; } };
hands();
listen();
void refresh();
