// Pages in a headless Chromium, with everything that a page must not do noted.

import { execFileSync } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

// The program, as `cargo build` leaves it.
const COAPT = process.env.COAPT ?? new URL("../../../../target/debug/coapt", import.meta.url).pathname;
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

export const folder = mkdtempSync(join(tmpdir(), "coapt-page-"));

export function coapt(...words) {
  return execFileSync(COAPT, words, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
}

export function write(name, text) {
  writeFileSync(join(folder, name), text);
}

// `more`: further switches of the browser.
export function launch(more = []) {
  // Debian's own Chromium; there may be no graphics card, and no network to look for.
  const args = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking", ...more];
  return chromium.launch({ executablePath: CHROMIUM, args });
}

// Opens a page from the folder. `complaints`: what it wrote to the console, threw, or asked the network for.
export async function open(browser, name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 1000 }, ...options });
  const page = await context.newPage();
  const complaints = [];
  page.on("console", (message) => complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) complaints.push(`asked for ${request.url()}`);
  });
  await page.goto(`file://${join(folder, name)}`);
  await settled(page);
  return { page, complaints };
}

// Two frames later everything that was asked for is drawn; what moved is drawn coarsely on a slow machine, and in full once it rests.
export async function settled(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done()))));
  await page.waitForFunction(() => [...document.querySelectorAll("canvas[aria-hidden]")].every(({ style }) => style.display === "none"));
}

// What a canvas shows: how much of it is not its background, and its pixels as text to compare.
export function pixels(page, id) {
  return page.evaluate((id) => {
    const canvas = document.getElementById(id);
    const copy = new OffscreenCanvas(canvas.width, canvas.height);
    const pen = copy.getContext("2d");
    pen.drawImage(canvas, 0, 0);
    const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
    let drawn = 0;
    let sum = 0;
    for (let at = 0; at < data.length; at += 4) {
      if (data[at] !== data[0] || data[at + 1] !== data[1] || data[at + 2] !== data[2]) drawn += 1;
      sum = (sum * 31 + data[at] * 7 + data[at + 1] * 3 + data[at + 2]) % 4294967291;
    }
    return { share: drawn / (data.length / 4), sum };
  }, id);
}
