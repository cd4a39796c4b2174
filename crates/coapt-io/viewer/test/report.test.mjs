// Reports in a real browser: pictures are there, controls do what they say, and nothing is asked of the network.

import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { coapt, folder, launch, open, pixels, settled, write } from "./browser.mjs";

let browser;
let planText;
const PLAN = `
schema_version = 1
name = "rings & <clips>"
diastole = true
sensitivities = true

[search]
alternative = 0
key = "size_mm"
from = 34
to = 28
tolerance = 1
measure = "coaptation/length_a2p2_mm"
at_least = 6.0

[[alternative]]
[[alternative.repair]]
kind = "ring"
family = "physio-like"
size_mm = [28, 30, 32]

[[alternative]]
[[alternative.repair]]
kind = "clip"
site = ["A1P1", "A2P2", "A3P3"]
`;

before(async () => {
  coapt("closure", "dilated", "--ring", "physio-like:30", "--out", "ring", "--record", "ring/closing.mcap", "--frames", "12");
  coapt("report", "ring", "-o", "ring.html");
  coapt("closure", "healthy", "--out", "alone");
  coapt("report", "alone", "-o", "alone.html");
  write("plan.toml", PLAN);
  planText = coapt("plan", "dilated", "plan.toml", "--out", "plan", "--shapes");
  coapt("report", "plan", "-o", "plan.html");
  browser = await launch();
});

after(() => browser?.close());

// Does something to the page and tells what the valve showed before and after.
async function change(page, act) {
  const earlier = await pixels(page, "view");
  await act();
  await settled(page);
  return [earlier, await pixels(page, "view")];
}

function assertChanged([earlier, later], what) {
  assert.notEqual(earlier.sum, later.sum, `${what} changes no pixel`);
  assert.ok(later.share > 0.03, `${what} leaves an empty picture: ${later.share}`);
}

test("the valve is drawn and its numbers are those of the report", async () => {
  const { page, complaints } = await open(browser, "ring.html");
  const { share } = await pixels(page, "view");
  // The annulus alone encloses a tenth of the picture; a valve that fills it would be cut off.
  assert.ok(share > 0.05 && share < 0.8, `${share} of the picture is drawn`);
  await page.waitForFunction(() => document.getElementById("unrolled").width > 300);
  const unrolled = await pixels(page, "unrolled");
  assert.ok(unrolled.share > 0.2, `${unrolled.share} of the map is drawn`);
  const report = JSON.parse(readFileSync(join(folder, "ring", "report.json"), "utf8"));
  const row = page.locator("tr", { hasText: "contact area" });
  const [, , told, repaired] = await row.locator("td").allTextContents();
  assert.equal(told, report.before.coaptation.area_mm2.toFixed(1));
  assert.equal(repaired, report.after.coaptation.area_mm2.toFixed(1));
  assert.match(await page.locator(".notice").textContent(), /research use, not a medical device/i);
  assert.equal(await page.locator(".verdict.certified").count(), 2);
  assert.deepEqual(complaints, []);
});

test("before, after and side by side", async () => {
  const { page, complaints } = await open(browser, "ring.html");
  assert.equal(await page.locator("#titles span").textContent(), "after: certified");
  assertChanged(await change(page, () => page.click("[data-shown=before]")), "before");
  assert.equal(await page.locator("#titles span").textContent(), "before: certified");
  assertChanged(await change(page, () => page.click("[data-shown=both]")), "side by side");
  assert.deepEqual(await page.locator("#titles span").allTextContents(), ["before: certified", "after: certified"]);
  assert.equal(await page.locator("[data-shown=both]").getAttribute("aria-pressed"), "true");
  assert.deepEqual(complaints, []);
});

test("colours, chordae, mesh, direction and keys", async () => {
  const { page, complaints } = await open(browser, "ring.html");
  const names = await page.locator("#quantity option").evaluateAll((options) => options.map((option) => option.value));
  assert.deepEqual(names, ["gap_mm", "contact", "strain", "displacement_mm", "annulus_distance_mm", "leaflet"]);
  for (const name of names.slice(1)) {
    assertChanged(await change(page, () => page.selectOption("#quantity", name)), name);
    const label = await page.locator(`#quantity option[value=${name}]`).textContent();
    assert.ok((await page.locator("#legend-title").textContent()).startsWith(label));
  }
  for (const id of ["chordae", "edges"]) assertChanged(await change(page, () => page.click(`#${id}`)), id);
  for (const direction of ["ventricle", "front", "side", "atrium"]) {
    assertChanged(await change(page, () => page.click(`[data-direction=${direction}]`)), direction);
  }
  await page.focus("#view");
  for (const key of ["ArrowLeft", "ArrowDown", "+", "-"]) assertChanged(await change(page, () => page.keyboard.press(key)), key);
  assert.deepEqual(complaints, []);
});

// Turns the valve with each of some frames of a page whose frames seem to take so long, and tells what is then shown.
async function turned(frame_ms) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 1000 } });
  await context.addInitScript((frame_ms) => {
    const real = window.requestAnimationFrame.bind(window);
    let now_ms = 0;
    real(function step() {
      now_ms += frame_ms;
      real(step);
    });
    window.requestAnimationFrame = (act) => real(() => act(now_ms));
  }, frame_ms);
  const page = await context.newPage();
  await page.goto(`file://${join(folder, "ring.html")}`);
  await settled(page);
  const box = await page.locator("#view").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const earlier = await pixels(page, "view");
  await page.mouse.move(x, y);
  await page.mouse.down();
  const moving = await page.evaluate(([x, y]) => new Promise((done) => {
    const view = document.getElementById("view");
    let left = 30;
    requestAnimationFrame(function step() {
      left -= 1;
      view.dispatchEvent(new PointerEvent("pointermove", { bubbles: true, pointerId: 1, pointerType: "mouse", buttons: 1, clientX: x + 40 + 5 * left, clientY: y }));
      if (left > 0) return requestAnimationFrame(step);
      const quick = document.querySelector("canvas[aria-hidden]");
      return done({ full: view.width, quick: quick && quick.style.display !== "none" ? quick.width : null });
    });
  }), [x, y]);
  await page.mouse.up();
  return { page, earlier, moving };
}

test("a machine too slow for the valve turns it coarsely, and draws it in full at rest", async () => {
  const { page, earlier, moving } = await turned(131);
  assert.ok(moving.quick && moving.quick <= 0.5 * moving.full, JSON.stringify(moving));
  await page.waitForFunction(() => document.querySelector("canvas[aria-hidden]").style.display === "none");
  const later = await pixels(page, "view");
  assert.notEqual(later.sum, earlier.sum, "the valve at rest is not the one that was turned");
  assert.equal(await page.locator("#view").evaluate((canvas) => canvas.width), moving.full);
});

test("a machine that is fast enough turns it as finely as it shows it at rest", async () => {
  const { moving } = await turned(16);
  assert.equal(moving.quick, null);
});

test("opening the valve", async () => {
  const { page, complaints } = await open(browser, "alone.html");
  assert.equal(await page.locator("#pose-value").textContent(), "closed at 100 mmHg");
  assertChanged(await change(page, () => page.fill("#pose", "0")), "opening");
  assert.equal(await page.locator("#pose-value").textContent(), "open, as given");
  assert.equal(await page.locator("[data-shown]").count(), 0);
  assert.deepEqual(complaints, []);
});

test("a film: every frame under its pressure, curves beside it, and it plays to its end", async () => {
  const { page, complaints } = await open(browser, "ring.html");
  assert.equal(await page.locator("#pose").getAttribute("max"), "12");
  const words = [];
  for (const frame of ["1", "4", "8", "12"]) {
    const drawn = await change(page, () => page.fill("#pose", frame));
    if (frame !== "12") assertChanged(drawn, `frame ${frame}`);
    words.push(await page.locator("#pose-value").textContent());
  }
  assert.equal(words[0], "0 mmHg");
  assert.equal(words[3], "closed at 100 mmHg");
  const pressures = words.slice(0, 3).map((text) => Number.parseFloat(text));
  assert.ok(pressures[0] < pressures[1] && pressures[1] < pressures[2], words.join());
  // Orifice and contact, before is not shown: two lines.
  assert.equal(await page.locator("#curves polyline").count(), 2);
  await page.click("#play");
  await page.getByText("Pause").waitFor();
  await page.waitForFunction(() => document.getElementById("play").textContent === "Close the valve", null, { timeout: 60_000 });
  assert.equal(await page.locator("#pose-value").textContent(), "closed at 100 mmHg");
  assert.deepEqual(complaints, []);
});

test("without a film there are no curves", async () => {
  const { page } = await open(browser, "alone.html");
  assert.ok(await page.locator("#curves-block").isHidden());
});

test("the section is where its slider says", async () => {
  const { page, complaints } = await open(browser, "ring.html");
  const middle = await page.locator("#section").innerHTML();
  // Two leaflets open and closed, of some ten segments each.
  const lines = await page.locator("#section path").evaluateAll((paths) => paths.map((path) => path.getAttribute("d").split("M").length - 1));
  assert.equal(lines.length, 4);
  assert.ok(lines.every((count) => count > 5), lines.join());
  await page.fill("#section-offset", "-6");
  assert.notEqual(await page.locator("#section").innerHTML(), middle);
  assert.equal(await page.locator("#section-value").textContent(), "6 mm to the anterolateral side");
  assert.deepEqual(complaints, []);
});

test("a plan: rows choose what is shown, the first-ranked at first", async () => {
  const { page, complaints } = await open(browser, "plan.html");
  assert.equal(await page.locator("h1").textContent(), "dilated: rings & <clips>");
  const report = JSON.parse(readFileSync(join(folder, "plan", "plan.json"), "utf8"));
  assert.equal(await page.locator("#after-heading").textContent(), report.alternatives[0].name);
  const last = report.alternatives.at(-1);
  const line = page.locator("tr[data-state]").last();
  assertChanged(await change(page, () => line.press("Enter")), "another row");
  assert.equal(await page.locator("#after-heading").textContent(), last.name);
  assert.equal(await line.getAttribute("aria-selected"), "true");
  const cells = await page.locator("tr", { hasText: "contact area" }).locator("td").allTextContents();
  assert.equal(cells[3], last.coaptation.area_mm2.toFixed(1));
  assert.equal(await page.locator("[data-details]:visible").count(), 2);
  assert.deepEqual(complaints, []);
});

test("a plan tells gradients, rates and its search as the program does", async () => {
  const { page, complaints } = await open(browser, "plan.html");
  const flat = (text) => text.replace(/\s+/g, " ");
  const beside = await page.locator(".beside li").allTextContents();
  const text = flat(planText);
  for (const line of beside) assert.ok(text.includes(flat(line)), `the program does not say: ${line}`);
  for (const start of ["open without pressure: ", "per mm of repair[0].size: ", "per 1 % of length"]) {
    assert.ok(beside.some((line) => line.startsWith(start)), `${start}${beside.join("; ")}`);
  }
  const report = JSON.parse(readFileSync(join(folder, "plan", "plan.json"), "utf8"));
  assert.equal(await page.locator(".beside tr").count(), 1 + report.alternatives.length);
  assert.ok(text.includes(flat(await page.locator(".search p").textContent()).replace(/\.$/, "")));
  assert.equal(await page.locator(".search tbody tr").count(), report.search.tried.length);
  assert.equal(await page.locator(".search tr", { hasText: "the answer" }).count(), 1);
  assert.match(await page.locator(".alternatives thead").textContent(), /mean gradient, at most \[mmHg\]/);
  assert.equal(await page.locator(".alternatives tr", { hasText: "FOUND BY SEARCH" }).count(), 1);
  assert.deepEqual(complaints, []);
});

test("on a desktop the measures have room: nothing scrolls but the page", async () => {
  for (const name of ["ring.html", "plan.html"]) {
    const { page } = await open(browser, name);
    const [all, seen] = await page.locator(".numbers .scroll").evaluate((box) => [box.scrollHeight, box.clientHeight]);
    assert.ok(all > 600 && all <= seen, `${all} in ${seen}`);
    assert.ok(await page.evaluate(() => document.scrollingElement.scrollWidth <= window.innerWidth));
  }
});

test("a tablet shows everything without scrolling sideways, paper has pictures and tables", async () => {
  const { page } = await open(browser, "plan.html", { viewport: { width: 820, height: 1180 } });
  assert.ok(await page.evaluate(() => document.scrollingElement.scrollWidth <= window.innerWidth));
  assert.ok((await pixels(page, "view")).share > 0.05);
  const paper = await page.pdf({ format: "A4" });
  assert.ok(paper.length > 50_000, `${paper.length} bytes`);
});

test("without WebGL the page says so, and all else works", async () => {
  const without = await launch(["--disable-3d-apis"]);
  try {
    const { page } = await open(without, "ring.html");
    assert.match(await page.locator(".no-webgl").textContent(), /WebGL/);
    const section = await pixels(page, "unrolled");
    assert.ok(section.share > 0.2, `${section.share} of the map is drawn`);
    await page.click("[data-shown=before]");
    assert.equal(await page.locator("#titles span").textContent(), "before: certified");
  } finally {
    await without.close();
  }
});

test("without scripts all numbers are there", async () => {
  const context = await browser.newContext({ javaScriptEnabled: false });
  const page = await context.newPage();
  await page.goto(`file://${join(folder, "ring.html")}`);
  assert.ok((await page.locator("section.numbers tr").count()) > 30);
  assert.match(await page.locator("noscript").first().innerHTML(), /need scripts/);
});

test("pages are small", () => {
  // Ten alternatives of 650 triangles in 3 MB: six come to two thirds of it at most.
  assert.ok(statSync(join(folder, "plan.html")).size < 2_000_000);
});
