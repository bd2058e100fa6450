// The live view's page in headless Chromium: what it draws of a run and of a recording, and what its controls do.
// Ends with an error at the first violation.

const fs = require("fs");
const os = require("os");
const path = require("path");
const { chromium } = require("playwright-core");
const { execFileSync } = require("child_process");
const { start, check, run } = require("./live_run");

const [program, picture] = process.argv.slice(2);
const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

/** The page's own account of what it drew (`window.view`), and of its state. */
const look = (page) => page.evaluate(() => ({ ...view.drawing.drawn, time: view.time, paused: view.paused, updates: view.counters.updates, frames: view.counters.frames, scale: view.camera.scale, status: document.getElementById("status").textContent }));

/** Waits until `condition` holds in the page, where its policy forbids Playwright's own way. */
async function until(page, what, condition, argument) {
  for (let tries = 0; tries < 400; ++tries) {
    if (await page.evaluate(condition, argument)) return;
    await new Promise((done) => setTimeout(done, 50));
  }
  throw new Error(`${what}: ${JSON.stringify(await look(page))}`);
}

/** Pixels of the canvas, of that colour within 12 per channel. */
const countPixels = (page, rgb) => page.evaluate(([r, g, b]) => {
  const canvas = document.getElementById("view"), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) count += Math.abs(data[i] - r) < 12 && Math.abs(data[i + 1] - g) < 12 && Math.abs(data[i + 2] - b) < 12;
  return count;
}, rgb);

async function open(browser, url, requests) {
  const page = await browser.newPage();
  page.on("pageerror", (error) => { console.error(error); process.exit(1); });
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(url);
  // Until the page has begun, `view` is its canvas of that name.
  await until(page, "no updates", () => window.view?.counters?.updates > 2 && view.drawing.drawn.robots > 0);
  return page;
}

async function watchRun(browser, requests) {
  const server = start(program, ["run", "worlds/simville/simville.world", "--view", "0", "--duration", "600"]);
  const url = await server.url;
  const page = await open(browser, url, requests);
  let now = await look(page);
  check(now.walls > 0 && now.markings > 100, `walls ${now.walls}, lane markings ${now.markings}`);
  check(Object.keys(now.lights).length > 0, "no traffic lights");
  check((await countPixels(page, [195, 200, 206])) > 500, "roads are not drawn");

  // A robot by the keyboard, its readings, a plot.
  await page.keyboard.press("]");
  await until(page, "no readings over the map", () => view.drawing.drawn.beams + view.drawing.drawn.edges + view.drawing.drawn.fields + view.drawing.drawn.cones > 0);
  await until(page, "no readings in the panel", () => [...document.querySelectorAll("#selected dd")].some((cell) => /\d/.test(cell.textContent)));
  const name = await page.textContent("#selected h2");
  check(name === (await page.textContent("#robots [aria-selected=true] span:nth-child(2)")), `list and panel differ: ${name}`);

  // Following, zooming, panning.
  await page.keyboard.press("f");
  await page.keyboard.press("+");
  const zoomed = await look(page);
  check(zoomed.scale > now.scale, "no zoom");
  await until(page, "not followed", () => Math.abs(view.camera.x - view.fleet.shownX[view.drawing.selected]) < 1e-9);
  await until(page, "no trail", () => view.fleet.trailCount[view.drawing.selected] > 3);
  if (picture) {
    await page.evaluate(() => new Promise((done) => setTimeout(done, 6000)));
    await page.screenshot({ path: picture });
  }
  await page.keyboard.press("0");
  check((await page.getAttribute("#follow", "aria-pressed")) === "false", "still followed");

  // Pause, step, continue, restart.
  await page.keyboard.press("Space");
  await until(page, "not paused", () => view.paused && document.getElementById("status").textContent === "paused");
  const { tick } = await page.evaluate(() => ({ tick: view.fleet.tick }));
  await page.keyboard.press("n");
  await until(page, "no step", (before) => view.fleet.tick === before + 1, tick);
  await page.click("#pause");
  await until(page, "not continued", (before) => !view.paused && view.fleet.tick > before + 1, tick);
  await page.selectOption("#speed", "4");
  await page.keyboard.press("Shift+R");
  await until(page, "not restarted", (before) => view.fleet.tick < before, tick);

  // A click on a robot selects it; a click beside all selects none.
  await page.evaluate(() => view.connection.set(["/paused", true]));
  await until(page, "not at rest", () => view.paused && view.fleet.shownX[1] === view.fleet.x[1] && view.fleet.shownY[1] === view.fleet.y[1]);
  const at = await page.evaluate(() => { const [x, y] = view.camera.toScreen(view.fleet.shownX[1], view.fleet.shownY[1]), box = document.getElementById("view").getBoundingClientRect(); return [box.x + x, box.y + y]; });
  await page.mouse.click(...at);
  await until(page, "not picked", () => view.drawing.selected >= 0 && view.drawing.drawn.selected >= 0);
  await page.keyboard.press("Escape");
  await until(page, "not left", () => view.drawing.selected === -1);

  check((await server.end()) === 130, "the program did not exit as interrupted before its --duration");
  await until(page, "the end is not shown", () => document.getElementById("status").dataset.state === "lost");
  await page.close();
}

async function watchManyRobots(browser, requests) {
  const server = start(program, ["run", "worlds/cave.world", "--robots", "300", "--view", "0"]);
  const page = await open(browser, await server.url, requests);
  await until(page, "not all robots", () => view.drawing.drawn.robots === 300);
  await page.fill("#search", "roomba299");
  await page.keyboard.press("Enter");
  await until(page, "no scan", () => view.drawing.drawn.hits > 0);
  check((await countPixels(page, [179, 89, 0])) > 20, "no echoes on the map");
  await page.close();
  check((await server.end()) === 0, "the program failed");
}

async function watchRecording(browser, requests) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "view-"));
  execFileSync(program, ["run", "worlds/mapping/mapping.world", "--duration", "8", "--record", folder, "--record-readings"], { stdio: "ignore" });
  const server = start(program, ["view", folder, "--port", "0"]);
  const page = await open(browser, await server.url, requests);
  await until(page, "no slider", () => !document.getElementById("timeline").hidden && Number(document.getElementById("slider").max) > 7.8);
  await page.keyboard.press("]");
  await page.keyboard.press("Space");
  await until(page, "not paused", () => view.paused);
  await page.locator("#slider").fill("7.5");
  await until(page, "not there", () => Math.abs(view.time - 7.5) < 0.11 && view.drawing.drawn.maps > 0);
  const cells = () => page.evaluate(() => [...view.drawing.maps.values()].reduce((sum, map) => sum + map.cells.free, 0));
  const late = await cells();
  await page.locator("#slider").fill("2.5");
  await until(page, "not back", () => Math.abs(view.time - 2.5) < 0.11);
  await until(page, "the map did not shrink", (most) => { const [map] = view.drawing.maps.values(); return map.cells.free > 0 && map.cells.free < most; }, late);
  await page.close();
  check((await server.end()) === 0, "the program failed");
  fs.rmSync(folder, { recursive: true });
}

async function main() {
  const profile = fs.mkdtempSync(path.join(os.tmpdir(), "chromium-"));
  const browser = await chromium.launchPersistentContext(profile, { executablePath: process.env.CHROMIUM, headless: true, args: flags, viewport: { width: 1366, height: 768 } });
  const requests = [];
  for (const part of [watchRun, watchManyRobots, watchRecording]) {
    const since = Date.now();
    await part(browser, requests);
    console.log(`${part.name}: ${((Date.now() - since) / 1000).toFixed(1)} s`);
  }
  const foreign = requests.filter((url) => !/^(http|ws):\/\/127\.0\.0\.1:|^data:/.test(url));
  check(foreign.length === 0, `the page asked elsewhere: ${foreign}`);
  await browser.close();
  fs.rmSync(profile, { recursive: true, force: true });
  console.log(`${requests.length} requests, all to this machine`);
}

run(main);
