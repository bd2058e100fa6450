// Checks the live view's page in headless Chromium: its drawing of a run and of a recording, and its controls.
// Exits with an error at the first violation.

const fs = require("fs");
const http = require("http");
const os = require("os");
const path = require("path");
const { chromium } = require("playwright-core");
const { execFileSync } = require("child_process");
const { start, check, run } = require("./live_run");

const [program, picture] = process.argv.slice(2);
const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream"];

/** Contents of the page's last frame (`window.view`), and its state. */
const look = (page) => page.evaluate(() => ({ ...view.drawing.drawn, time: view.time, paused: view.paused, updates: view.counters.updates, frames: view.counters.frames, scale: view.camera.scale, status: document.getElementById("status").textContent }));

/** Waits until `condition` is true in the page; the page's policy forbids Playwright's own function. */
async function until(page, what, condition, argument) {
  for (let tries = 0; tries < 400; ++tries) {
    if (await page.evaluate(condition, argument)) return;
    await new Promise((done) => setTimeout(done, 50));
  }
  throw new Error(`${what}: ${JSON.stringify(await look(page))}`);
}

/** Counts the canvas pixels of that colour within 12 per channel. */
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
  // Before the page's script has run, `view` is the canvas with that id.
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

  // Select a robot with the keyboard; its readings; a plot.
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

  // A click on a robot selects it; a click elsewhere clears the selection.
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

/**
 * Runs in the page for 4 s. Returns the largest distance of an echo from the nearest wall or robot at the time of its
 * measurement, and of the drawn sensor's pose from the drawn robot's.
 */
async function measureEchoes() {
  const walls = [], [ox, oy] = view.scene.origin, { fleet, drawing } = view, me = drawing.selected;
  for (const { lines } of view.scene.walls) for (const line of lines) for (let k = 0; k + 3 < line.length; k += 2) walls.push([line[k], line[k + 1], line[k + 2], line[k + 3]]);
  const offWall = (x, y, [ax, ay, bx, by]) => { const dx = bx - ax, dy = by - ay, t = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1))); return Math.hypot(ax + t * dx - x, ay + t * dy - y); };
  const found = { surface: 0, apart: 0, turned: 0, scans: 0 };
  let last = null;
  for (const begin = performance.now(); performance.now() - begin < 4000; await new Promise(requestAnimationFrame)) {
    const held = [...drawing.held.values()].find(({ message }) => message.ranges);
    const mount = view.scene.movers[me].sensors.find(({ fov }) => fov).pose, yaw = fleet.shownYaw[me];
    const x = fleet.shownX[me] + Math.cos(yaw) * mount[0] - Math.sin(yaw) * mount[1] - ox, y = fleet.shownY[me] + Math.sin(yaw) * mount[0] + Math.cos(yaw) * mount[1] - oy;
    const turned = held.pose[2] - yaw - mount[2];
    found.apart = Math.max(found.apart, Math.hypot(held.pose[0] - x, held.pose[1] - y));
    found.turned = Math.max(found.turned, Math.abs(turned - 2 * Math.PI * Math.round(turned / (2 * Math.PI))));
    if (held === last) continue;
    last = held;
    ++found.scans;
    const robots = view.scene.movers.map((_, i) => (i === me ? null : fleet.poseAt(i, held.at))), { message, pose } = held;
    for (let i = 0; i < message.ranges.length; i += 5) {
      const range = message.ranges[i], angle = pose[2] + message.angle_min + i * message.angle_increment;
      if (!(range >= message.range_min && range < message.range_max)) continue;
      const ex = pose[0] + ox + range * Math.cos(angle), ey = pose[1] + oy + range * Math.sin(angle);
      let least = Infinity;
      for (const wall of walls) least = Math.min(least, offWall(ex, ey, wall));
      robots.forEach((robot, k) => { if (robot) least = Math.min(least, Math.abs(Math.hypot(robot[0] - ex, robot[1] - ey) - fleet.radius[k])); });
      found.surface = Math.max(found.surface, least);
    }
  }
  return found;
}

async function watchManyRobots(browser, requests) {
  const server = start(program, ["run", "worlds/cave.world", "--robots", "300", "--view", "0"]);
  const page = await open(browser, await server.url, requests);
  await until(page, "not all robots", () => view.drawing.drawn.robots === 300);
  await page.fill("#search", "roomba299");
  await page.keyboard.press("Enter");
  await until(page, "no scan", () => view.drawing.drawn.hits > 0);
  check((await countPixels(page, [179, 89, 0])) > 20, "no echoes on the map");

  // Robots of one model have distinct colours, the same in the list and on the map.
  const marks = await page.evaluate(() => { document.getElementById("search").value = ""; view.panel.fill(); return [...document.querySelectorAll("#robots .mark")].slice(0, 24).map((mark) => getComputedStyle(mark).backgroundColor); });
  check(new Set(marks).size === 24 && (await page.evaluate(() => view.drawing.byColor.size)) === 24, `colours ${marks}`);
  check((await page.evaluate(() => view.fleet.count === 300 && [...document.querySelectorAll("#fleet button")].map(({ textContent }) => /^\d+ (in contact|stuck|outside)$/.test(textContent)).join())) === "true,true,true", "no counts of the fleet");
  const { surface, apart, turned, scans } = await page.evaluate(measureEchoes);
  console.log(`${scans} scans: echoes at most ${surface.toFixed(4)} m off walls and robots, sensors ${apart.toFixed(3)} m and ${turned.toFixed(3)} rad off robots`);
  check(scans > 20 && surface < 0.02, "echoes are not where surfaces are");
  check(apart < 0.03 && turned < 0.1, "readings are not where their robot is drawn");
  await page.selectOption("#speed", "0");  // ticks between updates are not shown
  await until(page, "not faster", () => Number.parseFloat(document.getElementById("pace").textContent) > 1.5);
  const fast = await page.evaluate(measureEchoes);
  console.log(`${fast.scans} scans at full speed: echoes at most ${fast.surface.toFixed(4)} m off walls and robots`);
  check(fast.scans > 20 && fast.surface < 0.02, "echoes are not where surfaces are, at full speed");
  await page.close();
  check((await server.end()) === 0, "the program failed");
}

/** Dark or light theme as in the system until the user chooses; all controls are reachable on a phone; caps lock. */
async function watchThemesAndPhones(browser, requests) {
  const server = start(program, ["run", "worlds/rooms.world", "--view", "0", "--duration", "600"]);
  const page = await open(browser, await server.url, requests);
  const themeOf = () => page.evaluate(() => document.documentElement.dataset.theme);
  const paper = () => page.evaluate(() => [...view.drawing.context.getImageData(3, view.drawing.canvas.height - 3, 1, 1).data].slice(0, 3).join());
  check((await themeOf()) === "light" && (await paper()) === "255,255,255", "not light");
  await page.emulateMedia({ colorScheme: "dark" });
  await until(page, "not dark", () => document.documentElement.dataset.theme === "dark");
  await until(page, "the map is not dark", () => view.drawing.context.getImageData(3, view.drawing.canvas.height - 3, 1, 1).data[0] === 20);
  await page.keyboard.press("t");
  check((await themeOf()) === "light", "T does not choose");
  await page.reload();
  await until(page, "no updates", () => window.view?.counters?.updates > 2);
  check((await themeOf()) === "light", "the choice is forgotten");
  await page.click("#theme");
  await page.emulateMedia({ colorScheme: "light" });
  await until(page, "the system is not followed again", () => document.documentElement.dataset.theme === "light");

  // The keys that the keyboard sends with caps lock on.
  const press = (key, shiftKey) => page.evaluate(([k, s]) => document.body.dispatchEvent(new KeyboardEvent("keydown", { key: k, shiftKey: s, bubbles: true })), [key, shiftKey]);
  await page.keyboard.press("]");
  await press("F", false);
  await until(page, "F with caps lock does not follow", () => document.getElementById("follow").getAttribute("aria-pressed") === "true");
  const { tick } = await page.evaluate(() => ({ tick: view.fleet.tick }));
  await press("R", false);
  await until(page, "no ticks", (before) => view.fleet.tick > before + 3, tick);  // R without Shift restarts nothing
  await press("r", true);
  await until(page, "Shift and R with caps lock do not restart", (before) => view.fleet.tick < before, tick);

  await page.setViewportSize({ width: 360, height: 640 });
  await until(page, "the map has no room", () => document.getElementById("view").clientHeight > 200 && document.getElementById("view").clientWidth === 360);
  const beyond = await page.evaluate(() => [...document.querySelectorAll("#bar button, #bar select, #clock, #status, #zoom button, #fleet button, #search")].filter((each) => { const box = each.getBoundingClientRect(); return box.width > 0 && (box.left < 0 || box.right > 360 || box.bottom > 640); }).map(({ id }) => id));
  check(beyond.length === 0 && (await page.evaluate(() => document.documentElement.scrollWidth)) === 360, `beyond the screen: ${beyond}`);
  await page.click("#show-panel");
  await until(page, "the panel does not give way", () => document.getElementById("view").clientHeight > 480);
  await page.setViewportSize({ width: 1366, height: 768 });
  await page.close();
  await server.end();
}

/** A robot driven into a wall is in contact, then stuck; a click on the count selects it. */
async function countFleet(browser, requests) {
  const server = start(program, ["run", "worlds/rooms.world", "--view", "0", "--speed", "8", "--duration", "6000"]);
  const page = await open(browser, await server.url, requests);
  const robot = await page.evaluate(() => { const row = view.scene.movers.findIndex(({ tag }) => !tag); view.select(row); return row; });
  // The field of view has the laser's colour of the world file, blue at 12 % on white, unless that layer is off.
  await until(page, "no scan", () => view.drawing.drawn.beams > 0);
  check((await page.evaluate((row) => view.scene.movers[row].sensors.find(({ fov }) => fov).color, robot)) === "#0000ff", "the laser is not blue");
  const blue = await countPixels(page, [224, 224, 255]);
  await page.evaluate(() => { view.drawing.layers.lasers = false; view.drawing.frame(); });
  check(blue > 500 && (await countPixels(page, [224, 224, 255])) < blue / 10, `${blue} blue pixels of the field of view`);
  await page.evaluate(() => { view.drawing.layers.lasers = true; });
  await page.keyboard.press("d");
  await page.keyboard.down("ArrowUp");
  await until(page, "not stuck", (row) => view.fleet.isStuck(row) && document.querySelector("#fleet [data-count=stuck]").textContent === "1 stuck", robot);
  check(await page.evaluate((row) => view.fleet.inContact(row) && !view.fleet.isOutside(row), robot), "stuck without contact");
  await page.keyboard.up("ArrowUp");
  await page.evaluate(() => view.select(-1));
  await page.click("#fleet [data-count=contact]");
  check((await page.evaluate(() => view.drawing.selected)) >= 0, "the count selects none");
  await page.close();
  await server.end();
}

/** If one of two fingers is lifted first, the map neither jumps nor stays behind. */
async function touchMap(browser, requests) {
  const server = start(program, ["run", "worlds/rooms.world", "--view", "0", "--duration", "600"]);
  const page = await open(browser, await server.url, requests);
  const at = () => page.evaluate(() => ({ x: view.camera.x, y: view.camera.y, scale: view.camera.scale, ground: view.camera.toWorld(300, 300) }));
  const touch = (type, pointerId, x, y) => page.evaluate(([kind, id, px, py]) => {
    const canvas = document.getElementById("view"), box = canvas.getBoundingClientRect();
    canvas.setPointerCapture = () => {};
    canvas.dispatchEvent(new PointerEvent(kind, { pointerId: id, pointerType: "touch", clientX: box.x + px, clientY: box.y + py, bubbles: true }));
  }, [type, pointerId, x, y]);
  const before = await at();
  await touch("pointerdown", 1, 250, 300);
  await touch("pointerdown", 2, 350, 300);
  await touch("pointermove", 1, 250, 300);
  await touch("pointermove", 2, 450, 300);
  const apart = await at();
  check(Math.abs(apart.scale / before.scale - 2) < 0.01, `pinch ${apart.scale / before.scale}`);
  await touch("pointerup", 2, 450, 300);
  await touch("pointermove", 1, 252, 300);
  await touch("pointermove", 1, 260, 300);
  const after = await at();
  check(Math.abs((apart.x - after.x) * after.scale - 10) < 1, `the map jumped by ${(apart.x - after.x) * after.scale} px`);
  await touch("pointerup", 1, 260, 300);
  check((await look(page)).selected === -1, "lifting a finger selects");
  await page.close();
  await server.end();
}

/** Three dimensions: solids, bodies and clouds of all robots; the plan view is as before, also without three.js. */
async function watchThird(browser, requests) {
  const server = start(program, ["run", "worlds/lidar.world", "--view", "0", "--duration", "600"]);
  let page = await open(browser, await server.url, requests);
  const noticed = () => page.evaluate(() => (document.getElementById("notice").hidden ? "" : document.getElementById("notice").textContent));
  await page.route("**/three.js", (route) => route.abort());
  await page.keyboard.press("v");
  await until(page, "no word of a missing three.js", () => /without three\.js/.test(document.getElementById("notice").textContent));
  check(await page.evaluate(() => document.getElementById("view-3d").hidden && view.third === null), "the plan view is gone");
  await page.close();

  const known = requests.length;
  page = await open(browser, await server.url, requests);
  check(!requests.slice(known).some((url) => /three\.js|_3d\.js/.test(url)), "the plan view loads parts of the other");
  await page.click("#third");
  await until(page, "neither three dimensions nor a word why", () => view.third !== null || !document.getElementById("notice").hidden);
  if (await page.evaluate(() => view.third === null)) {
    const why = await noticed();
    check(/three\.js|WebGL/.test(why), why);
    console.log(`three dimensions were not tested: ${why}`);
    await page.close();
    return server.end();
  }
  await until(page, "no clouds of both robots", () => view.third.counts.points > 5000 && view.third.drawn.walls > 40);
  check(/height/.test(await page.textContent("#notes")), "no notes");
  const painted = () => page.evaluate(() => {
    view.third.frame();
    const gl = view.third.renderer.getContext(), { width, height } = view.third.canvas, bytes = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    let count = 0;
    for (let i = 0; i < bytes.length; i += 4) count += bytes[i] < 235 || bytes[i + 1] < 235 || bytes[i + 2] < 235;
    return count / (width * height);
  });
  const all = await painted();
  check(all > 0.05 && all < 0.95, `drawn: ${all}`);
  // Drags turn the view, the wheel zooms, clicks select.
  const before = await page.evaluate(() => ({ ...view.third.orbit }));
  await page.mouse.move(500, 400);
  await page.mouse.down();
  await page.mouse.move(560, 420, { steps: 4 });
  await page.mouse.up();
  await page.mouse.wheel(0, -200);
  await until(page, "not turned", (was) => view.third.orbit.azimuth !== was.azimuth && view.third.orbit.elevation > was.elevation && view.third.orbit.distance < was.distance, before);
  await page.keyboard.press("0");
  await page.keyboard.press("]");
  await page.keyboard.press("f");
  await until(page, "not followed", () => view.third.orbit.target[0] !== 0 && view.drawing.selected === 0);
  await page.keyboard.press("Escape");
  const box = await page.evaluate(() => { const { x, y, width, height } = document.getElementById("view-3d").getBoundingClientRect(); return [x + width / 2, y + height / 2]; });
  await page.mouse.click(...box);
  await until(page, "not picked", () => view.drawing.selected === 0);
  // Roll, pitch and yaw as in base::rotation_of.
  const columns = await page.evaluate(async () => { const { poseMatrix } = await import("./bodies_3d.js"); return poseMatrix(window.THREE, { x: 1, y: 2, z: 3, yaw: 0.3 }, { roll: 0.1, pitch: 0.2 }).elements; });
  const { cos, sin } = Math, wanted = [cos(0.3) * cos(0.2), sin(0.3) * cos(0.2), -sin(0.2)];
  check(wanted.every((v, k) => Math.abs(columns[k] - v) < 1e-6) && Math.abs(columns[6] - cos(0.2) * sin(0.1)) < 1e-6 && columns[14] === 3, `pose ${columns}`);
  // The dark theme; without clouds; back in the plan view, which gets none.
  await page.keyboard.press("t");
  check((await painted()) > 0.95, "not dark");
  await page.keyboard.press("v");
  const { updates } = await page.evaluate(() => ({ ...view.third.counts }));
  await until(page, "no plan", () => !document.getElementById("view").hidden && view.drawing.drawn.robots === 2 && view.camera.width > 100);
  const { now, tick } = await page.evaluate(() => ({ now: view.third.counts.updates, tick: view.fleet.tick }));
  await until(page, "no ticks", (was) => view.fleet.tick > was + 5, tick);
  check((await page.evaluate(() => view.third.counts.updates)) <= now + 1 && now <= updates + 1, "clouds for the plan view");
  await page.keyboard.press("t");
  await page.close();
  await server.end();
}

/** Ten robots with lidars of 64 x 1 024 beams among blocks. */
function town() {
  const colors = ["tan", "salmon", "khaki", "gray70", "light blue", "pale green", "thistle"], lines = [
    "define rover position( size [0.8 0.6 0.4] drive \"diff\" ctrl \"wander\" lidar( preset \"OS1-64\" range [0.5 60] noise 0 size [0.2 0.2 0.15] ) laser( pose [0.3 0 -0.2 0] size [0.1 0.1 0.1] samples 181 fov 180 range_max 8 ) )",
    "model( name \"yard\" size [60 40 1.2] boundary 1 color \"gray50\" )", "model( name \"bridge\" pose [4.1 0 3 0] size [1.5 36 0.3] color \"gray60\" )"];
  for (let k = 0; k < 35; ++k) {
    const x = 8.2 * (k % 7 - 3), y = 7.6 * (Math.floor(k / 7) - 2), [a, b, c] = [5, 7, 11].map((factor) => (factor * k * k + k) % 13 / 13);
    lines.push(`model( name "block${k}" pose [${x} ${y} 0 ${30 * a - 15}] size [${2 + 2 * b} ${2 + 1.6 * c} ${[1, 1.6, 2.5, 4, 6][(k * k + 3 * k) % 5]}] color "${colors[k % 7]}" )`);
    if (k % 3 === 0 && k < 30) lines.push(`rover( name "rover${k / 3 + 1}" pose [${Math.min(20, x) + 4.1} ${Math.min(8, y) + 3.8} 0 ${70 * k}] )`);
  }
  return lines.join("\n");
}

/** Clouds are thinned out with a note. Prints the rates, which depend on the machine. */
async function watchTown(browser, requests) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "town-")), world = path.join(folder, "town.world");
  fs.writeFileSync(world, town());
  const server = start(program, ["run", world, "--view", "0", "--duration", "600"]);
  const page = await open(browser, await server.url, requests);
  await page.keyboard.press("v");
  await until(page, "neither three dimensions nor a word why", () => view.third !== null || !document.getElementById("notice").hidden);
  if (await page.evaluate(() => view.third !== null)) {
    await until(page, "no clouds", () => view.third.counts.points > 20000);
    check((await page.evaluate(() => view.third.counts.points)) <= 65536 + 20, "too many points");
    await until(page, "no note", () => /one in 11 beams/.test(document.getElementById("notes").textContent));
    const rates = await page.evaluate(async () => {
      const count = () => [performance.now() / 1000, view.third.counts.updates, view.third.drawn.frames], begin = count();
      await new Promise((done) => setTimeout(done, 3000));
      const [seconds, ...counts] = count().map((value, k) => value - begin[k]);
      return counts.map((value) => (value / seconds).toFixed(1));
    });
    console.log(`10 robots with 64 x 1 024 beams in three dimensions: ${rates[0]} updates/s, ${rates[1]} frames/s`);
    if (picture) {
      await page.evaluate(() => {  // as with a GPU
        Object.assign(view.third.orbit, { elevation: 0.62, azimuth: -1.9, distance: 0.5 * view.third.orbit.distance });
        Object.defineProperty(view.third, "share", { get: () => 1, set: () => {} });
        view.third.renderer.setPixelRatio(2);
        view.third.resize();
        view.select(3);
      });
      await page.evaluate(() => new Promise((done) => setTimeout(done, 2000)));
      await page.screenshot({ path: picture.replace(/(\.\w+)?$/, "-3d$1") });
    }
  }
  await page.close();
  await server.end();
  fs.rmSync(folder, { recursive: true });
}

/** Robots in a yard, one with a camera of a bending lens, a lidar, a map and tracks. */
function yard() {
  return `sun [-150 40]  floor_color "gray60"
define rover position( size [0.6 0.4 0.25]  color "steel blue"  drive "diff"  ctrl "wander"
  laser( name "scan" pose [0.25 0 0 0] size [0.1 0.1 0.1] samples 181 fov 270 range_max 8 rate 10 )  gps( rate 10 )  encoder( rate 20 )  gyro( rate 20 )
  derived( type "localization" inputs ["encoder" "gyro" "gps"] rate 20 )  derived( type "features" name "front" inputs ["laser:0"] rate 10 most 22 )
  derived( type "tracks" name "tracks" inputs ["features:0" "localization"] rate 10 )  occupancy( name "map" cell 0.1 words [40 40] offset [8 -8] sources ["laser:0"] rate 5 ) )
model( name "yard" size [14 12 1] boundary 1 color "gray50" )
model( name "house" pose [4 3.5 0 0] size [3 2 2] color "tan" )
model( name "kiosk" pose [3.4 -2.1 0 15] size [0.9 0.9 1.1] color "dark sea green" )
model( name "crate" pose [2.2 2 0 40] size [0.5 0.5 0.4] color "sienna" )
rover( name "rover1" pose [-4 0 0 0]  lidar( preset "VLP-16" columns 450 noise 0 size [0.1 0.1 0.08] rate 10 )
  camera( name "eye" resolution [640 480] fov 80 distortion [-0.2 0.04 0.001 -0.001 0] range [0 60] mono 1 jpeg 90 pose6 [0 0 0.05 3 14 2] rate 10 ) )
rover( name "rover2" pose [0 0.5 0 100] color "firebrick" )
rover( name "rover3" pose [1.5 -0.8 0 200] color "gold" )`;
}

/** Serves a PNG as /still.png and, in parts without an end, as /stream. */
async function serveImage(image) {
  const server = http.createServer(({ url }, answer) => {
    if (url.startsWith("/still.png")) return answer.writeHead(200, { "Content-Type": "image/png" }).end(image);
    answer.writeHead(200, { "Content-Type": "multipart/x-mixed-replace; boundary=frame" });
    for (let k = 0; k < 2; ++k) answer.write(Buffer.concat([Buffer.from(`--frame\r\nContent-Type: image/png\r\nContent-Length: ${image.length}\r\n\r\n`), image, Buffer.from("\r\n")]));
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  return server;
}

/** Pixels and depths of the newest lidar scan in the shown image. */
const echoesInImage = (page) => page.evaluate(() => {
  const { over } = view, [cloud] = over.state.cloudsAt(0, over.time).filter(({ planar }) => !planar), found = [];
  for (let i = 0; i < cloud.points.length; i += 4) {
    const p = [0, 1, 2].map((k) => cloud.points[i + k] + cloud.origin[k]), at = over.sight.pixelOf(p);
    if (at && over.sight.isInImage(at, -2)) found.push([...at, over.sight.inCamera(p)[2]]);
  }
  return { found, cloud: cloud.time, image: over.time };
});

/** The view over images: echoes lie on the pixels that see them, also from a calibration file; what it lacks, it says. */
async function watchOverlay(browser, requests) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "yard-")), world = path.join(folder, "yard.world");
  fs.writeFileSync(world, yard());
  const server = start(program, ["run", world, "--view", "0", "--duration", "600"]), known = requests.length;
  const page = await open(browser, await server.url, requests);
  check(!requests.slice(known).some((url) => /overlay|view_camera|lens/.test(url)), "the plan view loads parts of the other");
  const note = () => page.textContent("#view-camera .note");
  await page.keyboard.press("c");
  await until(page, "nothing over the image", () => { const { points = 0, robots, cells, tracks, arcs } = view.over?.drawn ?? {}; return points > 500 && robots === 2 && cells > 100 && tracks > 0 && arcs > 0; });
  check((await page.evaluate(() => view.drawing.selected)) === 0, "the camera's robot is not selected");
  const shades = await page.evaluate(() => {
    const [canvas] = document.querySelectorAll("#view-camera .picture canvas"), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const found = new Set();
    for (let i = 0; i < data.length; i += 4) found.add(data[i] === data[i + 1] && data[i] === data[i + 2] ? data[i] : "coloured");
    return [...found];
  });
  check(shades.length > 20 && !shades.includes("coloured"), `shades of a grey JPEG image: ${shades}`);
  if (picture) {
    await page.evaluate(() => new Promise((done) => setTimeout(done, 4000)));
    await page.screenshot({ path: picture.replace(/(\.\w+)?$/, "-overlay$1") });
  }

  // At one tick, the depth along the axis of each echo of the moving lidar is that of the pixel on which it lies.
  await page.keyboard.press("Space");
  await until(page, "not paused", () => view.paused && view.fleet.shownTime === view.fleet.time);
  await page.evaluate(() => {
    const { topic, type } = view.scene.movers[0].sensors.find(({ camera }) => camera), [{ name }] = view.scene.types[type].columns;
    view.connection.subscribe(topic, ({ header, [name.toLowerCase()]: depths }) => { window.depths = { header, depths }; }, { owner: "check" });
  });
  await until(page, "no depths", () => window.depths);
  await until(page, "images and scans of one time", () => { const stamp = window.depths.header.stamp.sec + 1e-9 * window.depths.header.stamp.nanosec; return Math.abs(stamp - view.over.time) < 1e-6 && view.over.state.cloudsAt(0, stamp).some(({ planar, time }) => !planar && Math.abs(time - stamp) < 1e-6); });
  const echoes = await echoesInImage(page), depths = await page.evaluate(() => Array.from(window.depths.depths));
  const agree = echoes.found.filter(([u, v, z]) => {
    const near = [-1, 0, 1].flatMap((dv) => [-1, 0, 1].map((du) => depths[640 * (Math.round(v) + dv) + Math.round(u) + du]));
    return z >= Math.min(...near) - 0.01 && z <= Math.max(...near) + 0.01;
  }).length;
  check(echoes.found.length > 500 && agree > 0.97 * echoes.found.length, `${agree} of ${echoes.found.length} echoes lie on their surfaces`);
  check(/robots at its time/.test(await note()), await note());

  // Each layer can be switched off.
  for (const key of ["robots", "scans", "map", "tracks", "intent"]) await page.click(`#camera-${key}`);
  await until(page, "layers", () => Object.values(view.over.drawn).every((count) => count === 0));
  for (const key of ["robots", "scans", "map", "tracks", "intent"]) await page.click(`#camera-${key}`);

  // The same image by its address, with the lens and the pose of the camera in a calibration file: the echoes lie where they lay.
  const shot = await page.evaluate(() => { const [canvas] = document.querySelectorAll("#view-camera .picture canvas"); return canvas.toDataURL("image/png").split(",")[1]; });
  const files = await serveImage(Buffer.from(shot, "base64")), address = `http://127.0.0.1:${files.address().port}`;
  const section = await page.evaluate(() => {
    const { camera: { size, focal, center, distortion, p, axes: [x, y, z] } } = view.scene.movers[0].sensors.find(({ camera }) => camera), w = 0.5 * Math.sqrt(1 + x[0] + y[1] + z[2]) || 1e-9;
    const q = [y[2] - z[1], z[0] - x[2], x[1] - y[0]].map((v) => v / (4 * w)).concat(w);
    return `[[camera]]\nname = "eye"\nsize = [${size}]\nfocal = [${focal}]\ncenter = [${center}]\ndistortion = [${distortion.slice(0, 5)}]\nposition = [${p}]\norientation = [${q}]\n`;
  });
  await page.selectOption("#view-camera .choices select", "url");
  check(/calibration file/.test(await note()), await note());
  const load = (text) => page.setInputFiles("#view-camera input[type=file]", { name: "lab.toml", mimeType: "application/toml", buffer: Buffer.from(text) });
  await load(section.replace("focal", "vocal"));
  await until(page, "no error of the file", () => /lab\.toml:1: 'focal' is missing/.test(document.querySelector("#view-camera .note").textContent));
  await load(section);
  await page.selectOption("#camera-mount", "0");
  for (const name of ["still.png", "stream"]) {
    await page.fill("#view-camera input[type=url]", `${address}/${name}`);
    await page.keyboard.press("Tab");
    await until(page, `no echoes over ${name}`, () => view.over.drawn.points > 500 && /states no time/.test(document.querySelector("#view-camera .note").textContent));
  }
  const again = await echoesInImage(page);
  check(again.found.length === echoes.found.length && again.found.every(([u, v], i) => Math.hypot(u - echoes.found[i][0], v - echoes.found[i][1]) < 0.01), `${again.found.length} echoes moved`);
  await page.fill("#view-camera input[type=url]", `${address.slice(0, -1)}/none.mp4`);
  await page.keyboard.press("Tab");
  await until(page, "no error of the address", () => /cannot be shown/.test(document.querySelector("#view-camera .note").textContent));
  await page.selectOption("#view-camera .choices select", "device");
  await until(page, "no image of the device", () => /scaled to the calibration|states no time/.test(document.querySelector("#view-camera .note").textContent) && view.over.drawn.points > 0);
  await page.keyboard.press("c");
  await until(page, "no plan", () => !document.getElementById("view").hidden && !view.connection.topics().some((name) => name === "none"));
  await page.close();
  await server.end();
  files.closeAllConnections();
  files.close();
  fs.rmSync(folder, { recursive: true });
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

/** The selected robot's cameras: a picture with the colours of its world, at a bounded rate, and depths in grey. */
async function watchPictures(browser, requests) {
  const server = start(program, ["run", "worlds/camera.world", "--view", "0", "--duration", "600"]);
  const page = await open(browser, await server.url, requests);
  await page.evaluate(() => view.select(view.scene.movers.findIndex(({ sensors }) => sensors.some(({ camera }) => camera))));
  const topic = await page.evaluate(() => view.scene.movers[view.drawing.selected].sensors.find(({ camera }) => camera).topic);
  await until(page, "no pictures", (name) => view.panel.picture(name).drawn > 3, topic);
  const seen = await page.evaluate((name) => {
    const { canvas, message } = view.panel.picture(name), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let red = 0;
    for (let i = 0; i < data.length; i += 4) red += data[i] > data[i + 1] + 40 && data[i] > data[i + 2] + 40;
    return { red, size: [canvas.width, canvas.height], bytes: message.data.length, readings: view.connection.topics().includes(name) };
  }, topic);
  check(seen.size.join() === "640,480" && seen.red > 1000, `the red robot: ${JSON.stringify(seen)}`);
  const [before, since] = await page.evaluate((name) => [view.panel.picture(name).drawn, performance.now()], topic);
  await until(page, "no further pictures", ([name, count]) => view.panel.picture(name).drawn > count + 20, [topic, before]);
  const rate = await page.evaluate(([name, count, begin]) => 1000 * (view.panel.picture(name).drawn - count) / (performance.now() - begin), [topic, before, since]);
  console.log(`${seen.bytes} bytes per picture, ${rate.toFixed(1)} pictures/s`);
  check(rate < 17, `${rate} pictures/s`);
  if (picture) await page.screenshot({ path: picture.replace(/(\.\w+)?$/, "-picture$1") });
  await page.close();
  await server.end();
}

/** The page of `vps`: the images of both cameras follow each other, and the table lists their tags. */
async function watchCameras(browser, requests) {
  const server = start(program, ["vps", "worlds/testbed.toml", "--rendered", "12", "--world", "worlds/testpath/testpath.world", "--view", "0"]);
  const page = await browser.newPage();
  page.on("pageerror", (error) => { console.error(error); process.exit(1); });
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(await server.url);
  const seen = () => [...(window.view?.cameras?.values() ?? [])].map(({ drawn }) => drawn);
  for (let tries = 0; tries < 400 && (await page.evaluate(seen)).filter((drawn) => drawn > 3).length < 2; ++tries) await new Promise((done) => setTimeout(done, 50));
  const drawn = await page.evaluate(seen);
  check(drawn.length === 2 && Math.min(...drawn) > 3, `images of cameras ${drawn}`);
  const rows = await page.evaluate(() => [...document.querySelectorAll("#tags tbody tr")].map((row) => [...row.cells].map(({ textContent }) => textContent)));
  check(rows.length > 5 && rows.every(([id, place, heading, speed]) => /^\d+$/.test(id) && /^−?\d+\.\d\d, −?\d+\.\d\d$/.test(place) && /^−?\d+°$/.test(heading) && /^\d\.\d\d$/.test(speed)), `tags ${JSON.stringify(rows)}`);
  const green = await page.evaluate(() => { const { canvas } = [...view.cameras.values()][0], { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height); let count = 0; for (let i = 0; i < data.length; i += 4) count += data[i + 1] > data[i] + 60 && data[i + 1] > data[i + 2] + 40; return count; });
  check(green > 200, `outlines of tags: ${green} pixels`);
  if (picture) await page.screenshot({ path: picture.replace(/(\.\w+)?$/, "-cameras$1") });
  await server.end();
  await page.close();
}

async function main() {
  const profile = fs.mkdtempSync(path.join(os.tmpdir(), "chromium-"));
  const browser = await chromium.launchPersistentContext(profile, { executablePath: process.env.CHROMIUM, headless: true, args: flags, viewport: { width: 1366, height: 768 } });
  const requests = [];
  for (const part of [watchRun, watchManyRobots, watchThemesAndPhones, countFleet, touchMap, watchThird, watchTown, watchOverlay, watchRecording, watchPictures, watchCameras]) {
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

run(main, 5);
