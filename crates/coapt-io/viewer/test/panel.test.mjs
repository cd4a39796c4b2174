// The panel in a Jupyter server: a slider is moved, and shape and numbers follow.
//
// PYTHON names a Python with coapt, anywidget and jupyterlab; without it nothing is tested here, and the run says so.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { createServer } from "node:net";
import { after, before, test } from "node:test";
import { folder, launch, pixels, write } from "./browser.mjs";

const { PYTHON } = process.env;
const TOKEN = "panel";
let browser;
let server;
let port;

const NOTEBOOK = {
  cells: [
    {
      cell_type: "code",
      id: "panel",
      execution_count: null,
      metadata: {},
      outputs: [],
      source: 'import coapt\ncoapt.generate("dilated").panel()',
    },
  ],
  metadata: { kernelspec: { name: "python3", display_name: "Python 3", language: "python" }, language_info: { name: "python" } },
  nbformat: 4,
  nbformat_minor: 5,
};

async function freePort() {
  const probe = createServer().listen(0, "127.0.0.1");
  await once(probe, "listening");
  const { port } = probe.address();
  probe.close();
  return port;
}

before(async () => {
  if (!PYTHON) return;
  write("panel.ipynb", JSON.stringify(NOTEBOOK));
  port = await freePort();
  const words = ["-m", "jupyterlab", "--no-browser", "--allow-root", "--ip=127.0.0.1", `--port=${port}`, `--IdentityProvider.token=${TOKEN}`, "--LabApp.news_url=None", "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate", "--LabApp.extension_manager=readonly"];
  // Folders of its own: no setting of this machine counts.
  const env = { ...process.env, HOME: folder, JUPYTER_RUNTIME_DIR: `${folder}/runtime`, JUPYTER_CONFIG_DIR: `${folder}/config` };
  server = spawn(PYTHON, words, { cwd: folder, env, stdio: "ignore" });
  const deadline = Date.now() + 120_000;
  for (;;) {
    const answer = await fetch(`http://127.0.0.1:${port}/api?token=${TOKEN}`).catch(() => null);
    if (answer?.ok) break;
    if (Date.now() > deadline || server.exitCode !== null) throw new Error("the Jupyter server does not answer");
    await new Promise((done) => setTimeout(done, 500));
  }
  browser = await launch();
});

after(async () => {
  await browser?.close();
  server?.kill();
});

test("a moved slider closes the valve anew", { skip: PYTHON ? false : "PYTHON is not set" }, async () => {
  const page = await (await browser.newContext({ viewport: { width: 1500, height: 1100 } })).newPage();
  await page.goto(`http://127.0.0.1:${port}/lab/tree/panel.ipynb?token=${TOKEN}`);
  // Keys that come before the kernel is there are lost.
  await page.getByText("| Idle").waitFor({ timeout: 120_000 });
  await page.locator(".jp-Notebook .cm-content").first().click();
  await page.keyboard.press("Shift+Enter");
  const panel = page.locator(".coapt-panel");
  await panel.locator("table").waitFor({ timeout: 120_000 });
  await panel.locator("canvas").evaluate((canvas) => (canvas.id = "panel-view"));
  const value = (name, column) => panel.locator("tr", { hasText: name }).locator("td").nth(column).textContent();
  assert.equal(await value("contact area", 1), await value("contact area", 2));
  const open = await pixels(page, "panel-view");
  assert.ok(open.share > 0.05, `${open.share} of the picture is drawn`);

  await panel.locator("select[name=ring_family]").selectOption("physio-like");
  await page.waitForFunction(() => document.querySelector(".coapt-panel").innerText.includes("+"), null, { timeout: 60_000 });
  const area = Number(await value("contact area", 2));
  assert.ok(area > Number(await value("contact area", 1)), `a ring of 30 mm makes ${area} mm² of contact`);
  const ringed = await pixels(page, "panel-view");
  assert.notEqual(ringed.sum, open.sum);

  const width = Number(await value("commissural width", 2));
  // As a hand would, faster than closures are: many values, of which the last must be the one that is shown.
  const size = panel.locator("input[name=ring_size_mm]");
  for (let size_mm = 29.5; size_mm >= 26; size_mm -= 0.5) await size.fill(String(size_mm));
  await page.waitForFunction((area) => {
    const cells = [...document.querySelectorAll(".coapt-panel tr")].find((row) => row.innerText.includes("commissural width"))?.cells;
    return cells && Number(cells[2].innerText) < area;
  }, width - 2, { timeout: 60_000 });
  assert.notEqual((await pixels(page, "panel-view")).sum, ringed.sum);
  assert.match(await panel.innerText(), /certified: converged/);
  assert.match(await panel.innerText(), /research use, not a medical device/);
  await size.press("ArrowRight");
  assert.equal(await size.inputValue(), "26.5", "arrow keys move sliders, not the notebook");
  if (process.env.SCREENSHOTS) await page.screenshot({ path: `${process.env.SCREENSHOTS}/panel.png` });
});
