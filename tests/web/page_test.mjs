// SPDX-License-Identifier: MIT
// The page of a study as a reader meets it, in headless Chromium, from file://.
// usage: node page_test.mjs PAGE CHROMIUM STUDY_WEB; prints what it checked, ends with 1 where something is wrong.
import assert from "node:assert/strict";
import {createRequire} from "node:module";
import {pathToFileURL} from "node:url";

const [path, chromium_path, study_web] = process.argv.slice(2);
const {chromium} = createRequire(study_web + "/")("playwright-core");
const own_address = pathToFileURL(path).href;
const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync"];

const problems = [];
let requests = 0, hovers = 0;

async function open(browser, width, height, address = own_address) {
  const context = await browser.newContext({viewport: {width, height}, offline: true});
  const page = await context.newPage();
  page.on("console", (message) => problems.push(`console ${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => problems.push(`error: ${error.stack}`));
  page.on("request", (request) => {
    ++requests;
    if (request.url() !== address && !request.url().startsWith("data:")) problems.push(`request: ${request.url()}`);
  });
  await page.goto(address);
  return page;
}

// To the middle of the window: its upper edge is under the selectors.
const bring = (page, id) => page.$eval("#" + id, (chart) => chart.scrollIntoView({block: "center"}));

// Texts that a chart draws.
const texts = (page, id) => page.$$eval(`#${id} svg text`, (all) => all.map((t) => t.textContent));

// Marks of a chart that stand alone, so that the pointer meets no other: [{point, x, y}], in pixels of the page.
const lone_marks = (page, id) => page.evaluate((id) => {
  const element = document.getElementById(id), chart = echarts.getInstanceByDom(element);
  const box = element.getBoundingClientRect();
  const marks = chart.getOption().series.flatMap((series, s) => (series.data || [])
    .filter((d) => d && d.point !== undefined)
    .map((d) => ({point: d.point, at: chart.convertToPixel({seriesIndex: s}, d.value)})));
  return marks.filter((m) => marks.every((o) => o === m || Math.hypot(o.at[0] - m.at[0], o.at[1] - m.at[1]) > 8))
    .map((m) => ({point: m.point, x: box.left + m.at[0], y: box.top + m.at[1]}));
}, id);

async function hover(page, id, mark) {
  await page.mouse.move(2, 2);
  await page.waitForSelector(`#${id} .tip`, {state: "hidden", timeout: 20000});
  await page.mouse.move(mark.x, mark.y);
  await page.waitForSelector(`#${id} .tip`, {state: "visible", timeout: 20000});
  ++hovers;
  return page.$eval(`#${id} .tip`, (tip) => tip.textContent);
}

const column = (page, name) => page.$$eval("#points tr", ([head, ...rows], name) => {
  const at = [...head.cells].findIndex((c) => c.textContent === name);
  if (at < 0) throw new Error("no column " + name);
  return rows.map((row) => row.cells[at].textContent);
}, name);
const press = (page, name) => page.locator("#points th button", {hasText: new RegExp(`^${name.replace(/[()]/g, "\\$&")}$`)}).click();
const as_number = (text) => {
  const [mantissa, power] = text.split("·10");
  return Number(mantissa) * 10 ** (power ? Number(power.replace(/./g, (c) => "-0123456789"["⁻⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(c)])) : 0);
};

async function charts_are_there(page, study) {
  assert.equal(await page.textContent("h1"), study.title);
  assert.match(await page.textContent("#summary"),
    /^265 points: 246 done, 17 unstable, 2 refused\. Machine: no machine: made-up numbers, 4 cores; of some points a <made-up> GPU\.$/);
  const settings = study.charts.filter((c) => c.section === "settings" && c.error === 0).length;
  assert.ok(settings >= 6);
  assert.equal((await page.$$(".chart svg")).length, 2 + settings);
  assert.ok((await texts(page, "error-speed-0")).includes("relative error of the worst figure"));
  await page.selectOption("#error", {label: "distance from the true trajectory, pitches (rms)"});
  const drawn = await texts(page, "error-speed-0");
  for (const text of ["lattice, fixed", "reference, double", "reference, float", "gpu, float (a <made-up> GPU)", "fpga, fixed", "Pareto front",
    "distance from the true trajectory, pitches (rms)", "simulated seconds per second", "below: the truth's own error"])
    assert.ok(drawn.includes(text), `the chart does not say '${text}': ${drawn}`);
  // As many marks as there are points with both numbers.
  const marks = await page.$$eval("#error-speed-0 svg path", (all, colours) => all.filter((p) =>
    colours.includes((p.getAttribute("fill") || "").toLowerCase())).length, study.series.map((s) => s.colour));
  const expected = study.points.filter((p, n) => p.status === "done" && study.errors.find((e) => e.id === "trajectory").values[n] !== null).length;
  assert.equal(expected, 246);
  assert.ok(marks >= expected && marks <= expected + study.series.length, `${marks} marks of ${expected} points`);
  assert.ok((await texts(page, "truth-0")).includes("dt²"));
  assert.match(await page.textContent("#truth-text"), /^Errors are measured against a run in doubles, its time step halved 5 times\. Its figures/);
  assert.deepEqual(await page.$$eval("#truth-notes li", (all) => all.map((note) => note.textContent)),
    ["strength changes by 2.3 % if every second sample is left out: more 'samples'", "a <second> note & more"]);
  const lengthened = await page.evaluate(() => truth_text({...study.truth, converged: false,
    rungs: [1, 1, 1.25, 1.5625, 1.953].map((cutoff) => ({...study.truth.rungs[0], cutoff}))}));
  assert.match(lengthened, /time step halved once, then its cutoff lengthened 3 times\. It has not converged to the study's tolerance\./);
}

const series_name = (point) => `${point.engine}, ${point.arithmetic}` + (point.machine ? ` (${point.machine})` : "");

async function hovering_tells_settings(page, study) {
  const error = study.errors.find((e) => e.id === "trajectory");
  const seen = new Set();
  await bring(page, "error-speed-0");
  for (const mark of await lone_marks(page, "error-speed-0")) {
    const point = study.points[mark.point], name = `${point.engine}, ${point.arithmetic}`;
    if (seen.has(series_name(point))) continue;
    const text = await hover(page, "error-speed-0", mark);
    assert.ok(text.startsWith(`Point ${mark.point + 1}engine${name}`), `hovering point ${mark.point + 1} shows: ${text}`);
    for (const [key, value] of [...point.scene, ...point.arch]) assert.ok(text.includes(key + value), `${key} = ${value} is not in: ${text}`);
    const shown = as_number(text.split(error.label)[1].match(/^[-0-9.]+(·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?/)[0]);
    assert.ok(Math.abs(shown / error.values[mark.point] - 1) < 1e-3, `${shown} is not the error of point ${mark.point + 1}`);
    assert.equal(text.includes("machine" + (point.machine || "")), point.machine !== "");
    assert.equal(text.includes("threads"), point.engine !== "gpu");
    seen.add(series_name(point));
  }
  assert.deepEqual([...seen].sort(), study.series.map((s) => s.name).sort());
  // The settings' charts tell as much.
  await bring(page, "settings-0");
  const [mark] = await lone_marks(page, "settings-0");
  assert.ok((await hover(page, "settings-0", mark)).startsWith(`Point ${mark.point + 1}engine`));
}

async function pressing_a_mark_finds_its_row(page) {
  await bring(page, "error-speed-0");
  const [mark] = await lone_marks(page, "error-speed-0");
  // A busy machine takes its time to draw, and to answer.
  await hover(page, "error-speed-0", mark);
  await page.mouse.click(mark.x, mark.y);
  await page.waitForSelector("#points tr.chosen", {state: "attached", timeout: 20000});
  const chosen = await page.$$eval("#points tr.chosen", (rows) => rows.map((r) => r.cells[0].textContent));
  assert.deepEqual(chosen, [String(mark.point + 1)]);
}

async function selectors_change_charts(page, study) {
  const table = () => page.textContent("#decades");
  const before = await table();
  await page.selectOption("#error", {label: "change of momentum, of the sum of |m v|"});
  let drawn = await texts(page, "error-speed-0");
  assert.ok(drawn.includes("change of momentum, of the sum of |m v|") && !drawn.includes("distance from the true trajectory, pitches (rms)"));
  // Fixed engines keep momentum to the last bit: an error of 0 has a place on the logarithmic axis.
  assert.ok(drawn.includes("0"), `no place for an error of 0: ${drawn}`);
  assert.ok(drawn.includes("unstable"), "unstable points have a momentum error and are drawn");
  const first = await page.$eval("#decades tbody tr:last-child th", (cell) => cell.textContent);
  assert.equal(first, "0");
  assert.notEqual(await table(), before);
  assert.ok((await texts(page, "settings-0")).includes("change of momentum, of the sum of |m v|"));

  const by_cost = await table();
  await page.selectOption("#speed", {label: "cost, transistors x time per simulated second (less is better)"});
  drawn = await texts(page, "error-speed-0");
  assert.ok(drawn.includes("cost, transistors x time per simulated second (less is better)"));
  assert.notEqual(await table(), by_cost);
  // Axes run from left to right: the cheapest point stands furthest to the left, and the chart says so.
  const places = await page.evaluate(() => {
    const chart = echarts.getInstanceByDom(document.getElementById("error-speed-0"));
    return chart.getOption().series.flatMap((s, k) => s.data.filter((d) => d.point !== undefined)
      .map((d) => [d.value[0], chart.convertToPixel({seriesIndex: k}, d.value)[0]]));
  });
  places.sort((a, b) => a[0] - b[0]);
  assert.ok(places[0][1] < places[places.length - 1][1]);
  assert.ok(drawn.includes("↙ better"), `no better corner: ${drawn}`);
  assert.match(await page.textContent("#error-speed + .note"), /further to the left/);

  await page.selectOption("#error", {label: "relative error of Young's modulus"});
  await page.selectOption("#speed", {label: "particle-steps per second"});
  drawn = await texts(page, "error-speed-0");
  assert.ok(drawn.includes("relative error of Young's modulus") && drawn.includes("particle-steps per second"));
  await page.selectOption("#error", {label: "distance from the true trajectory, pitches (rms)"});
  await page.selectOption("#speed", {label: "simulated seconds per second"});
  assert.equal(await table(), before);
  assert.equal(study.decades.length, study.errors.length);
}

async function tables_sort_and_filter(page, study) {
  const label = "distance from the true trajectory, pitches (rms)";
  const ascending = (cells) => cells.every((c, k) => k === 0 || as_number(cells[k - 1]) <= as_number(c));
  for (const falling of [false, true]) {
    await press(page, label);
    const cells = await column(page, label);
    assert.equal(cells.length, 265);
    const some = cells.filter((c) => c !== "–");
    assert.equal(some.length, 246);
    assert.ok(cells.slice(246).every((c) => c === "–"), "points without a value stand last");
    assert.ok(ascending(falling ? some.reverse() : some), `not sorted: ${some.slice(0, 5)}`);
    assert.equal(await page.getAttribute("#points th[aria-sort]", "aria-sort"), falling ? "descending" : "ascending");
  }
  await press(page, "status");
  assert.deepEqual([...new Set(await column(page, "status"))], ["done", "refused", "unstable"]);
  await press(page, "point");
  assert.deepEqual(await column(page, "point"), study.points.map((_, n) => String(n + 1)));

  const visible = () => page.$$eval("#points tbody tr", (rows) => rows.filter((r) => r.offsetHeight > 0).map((r) => r.textContent));
  await page.selectOption("#status", "refused");
  let rows = await visible();
  assert.equal(rows.length, 2);
  assert.ok(rows.every((r) => r.includes("the law's strongest pull takes 10 bits <strength_bits & sign>: more than it has")));
  await page.selectOption("#status", "");
  await page.fill("#filter", "FPGA");
  rows = await visible();
  assert.equal(rows.length, 4);
  assert.ok(rows.some((r) => r.includes("left the truth by 44 pitches at the horizon")));
  assert.equal(await page.textContent("#shown"), "4 of 265");
  // The charts show what the table does: of the four one is unstable, and has no such error.
  const drawn = () => page.evaluate(() => ["error-speed-0", "settings-0"].map((id) => echarts.getInstanceByDom(document.getElementById(id)).getOption()
    .series.flatMap((s) => (s.data || []).filter((d) => d.point !== undefined).map((d) => study.points[d.point].engine))));
  assert.deepEqual(await drawn(), [["fpga", "fpga", "fpga"], ["fpga", "fpga", "fpga"]]);
  await page.fill("#filter", "");
  assert.ok((await drawn()).every((engines) => engines.length >= 246));
}

// Heads of the table of all points that are in sight without scrolling it.
const heads_in_sight = (page) => page.$$eval("#points th", (all) => {
  const box = all[0].closest(".scroll").getBoundingClientRect();
  return all.filter((th) => th.getBoundingClientRect().left >= box.left && th.getBoundingClientRect().right <= box.right).map((th) => th.textContent);
});

// What was chosen, then all that was swept: six keys, engine and arithmetic.
async function table_shows_what_was_chosen(page, study) {
  const swept = [...new Set(study.points.flatMap((p) => [...p.scene, ...p.arch]).map(([key]) => key))];
  assert.equal(swept.length, 6);
  for (const error of ["change of momentum, of the sum of |m v|", "distance from the true trajectory, pitches (rms)"]) {
    await page.selectOption("#error", {label: error});
    const heads = await heads_in_sight(page);
    assert.deepEqual(heads.slice(0, 11), ["point", error, "simulated seconds per second", "engine", "arithmetic", ...swept]);
  }
  // Every column differs between these points.
  assert.equal(await page.textContent("#same"), "");
}

// A column with one value in all rows is none: a line above the table has it. What no point has is in neither.
async function equal_columns_are_folded(page) {
  const same = await page.textContent("#same"), heads = await page.$$eval("#points th", (all) => all.map((th) => th.textContent));
  for (const [name, value] of [["run.dt_safety", "0.03"], ["status", "done"], ["particles", "3456"]]) {
    assert.ok(same.includes(`${name} = ${value}`), `no '${name} = ${value}' in: ${same}`);
    assert.ok(!heads.includes(name), `'${name}' is a column as well`);
  }
  assert.match(same, /^All points have: .*\.$/s);
  assert.ok(!heads.includes("table.degree") && !same.includes("table.degree"));
  for (const name of ["point", "arithmetic", "integrator", "widths.position_frac"]) {
    assert.ok(heads.includes(name), `no column '${name}'`);
    assert.ok(!same.includes(name + " = "), `'${name}' is folded`);
  }
  // Of one point nothing is folded.
  await page.evaluate(() => { study.points.length = 1; fill_points(); });
  assert.equal(await page.textContent("#same"), "");
  assert.ok((await page.$$eval("#points th", (all) => all.map((th) => th.textContent))).includes("run.dt_safety"));
}

async function zooms_and_comes_back(page) {
  const ends = () => page.evaluate(() => echarts.getInstanceByDom(document.getElementById("error-speed-0")).getOption().dataZoom.map((z) => z.end - z.start));
  await bring(page, "error-speed-0");
  const box = await page.locator("#error-speed-0").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.keyboard.down("Shift");
  await page.mouse.wheel(0, -240);
  await page.keyboard.up("Shift");
  await page.waitForFunction(() => {
    const [x] = echarts.getInstanceByDom(document.getElementById("error-speed-0")).getOption().dataZoom;
    return x.end - x.start < 100;
  }, undefined, {timeout: 20000});
  await page.evaluate(() => echarts.getInstanceByDom(document.getElementById("error-speed-0")).dispatchAction({type: "restore"}));
  assert.ok((await ends()).every((d) => d === 100));
}

async function fits_a_phone(browser) {
  const page = await open(browser, 390, 844);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 390, "the page is wider than the screen");
  for (const box of await page.$$eval(".chart svg", (all) => all.map((s) => s.getBoundingClientRect().right))) assert.ok(box <= 390);
  await bring(page, "error-speed-0");
  const [mark] = await lone_marks(page, "error-speed-0");
  await hover(page, "error-speed-0", mark);
  const tip = await page.locator("#error-speed-0 .tip").boundingBox();
  assert.ok(tip.x >= 0 && tip.x + tip.width <= 390, "what a mark tells is cut");
  assert.ok(tip.height < 400, `what a mark tells is ${tip.height} pixels high`);
  await cheapest_points_have_their_settings(page);
  await page.context().close();
}

// All of a cheapest point is on a phone, and its settings are those of the point.
async function cheapest_points_have_their_settings(page) {
  const rows = await page.$$eval("#decades tbody tr", (all) => all.map((row) => ({point: Number(row.dataset.point),
    settings: row.querySelector("td.settings").textContent, sides: [...row.cells].map((cell) => cell.getBoundingClientRect())
      .map((box) => [box.left, box.right, box.height])})));
  assert.equal(rows.length, 3);
  const points = await page.evaluate(() => study.points);
  for (const row of rows) {
    for (const [key, value] of [...points[row.point].scene, ...points[row.point].arch])
      assert.ok(row.settings.includes(`${key} ${value}`), `no ${key} ${value} in: ${row.settings}`);
    for (const [left, right, height] of row.sides) assert.ok(left >= 0 && right <= 390 && height > 0, `a cell from ${left} to ${right}, ${height} high`);
  }
}

async function prints(page) {
  await page.emulateMedia({media: "print"});
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  const widths = await page.$$eval(".chart svg", (all) => all.map((s) => s.getBoundingClientRect().width));
  assert.ok(widths.every((w) => w <= 680), `charts of ${widths} pixels are cut on paper`);
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  await page.emulateMedia({media: "screen"});
}

// Whatever the results say is text: no element comes of it, nothing runs, and what a mark tells is no markup.
async function hostile_text_is_text(browser) {
  const before = problems.length;
  const page = await open(browser, 1280, 900, pathToFileURL(path.replace(/page\.html$/, "hostile.html")).href);
  page.on("dialog", (dialog) => { problems.push(`dialog: ${dialog.message()}`); dialog.dismiss(); });
  const study = await page.$eval("#data", (data) => JSON.parse(data.textContent));
  assert.ok(study.title.includes("<script>alert(1)</script>") && study.title.includes("\u001b]0;"));
  // A title of a document is shown with the controls' escapes.
  assert.ok((await page.textContent("h1")).startsWith("x\nsystem("));
  await page.evaluate(() => study.points.forEach((_, n) => document.body.insertAdjacentHTML("beforeend", tip(n))));
  await page.evaluate(() => {
    const chart = echarts.getInstanceByDom(document.getElementById("error-speed-0"));
    const seriesIndex = chart.getOption().series.findIndex((s) => s.data.some((d) => d.point !== undefined));
    chart.dispatchAction({type: "showTip", seriesIndex, dataIndex: 0});
  });
  await page.waitForSelector("#error-speed-0 .tip", {state: "visible", timeout: 20000});
  assert.ok((await page.$eval("#error-speed-0 .tip", (tip) => tip.textContent)).includes("<script>alert(1)</script>"));
  for (const unwanted of ["img", "body script:not(#data) ~ script ~ script", "[onload]", "[onerror]", ".tip script"])
    assert.equal((await page.$$(unwanted)).length, 0, `the page has a '${unwanted}'`);
  assert.ok((await page.textContent("#points")).includes("<img src=x onerror=alert(2)>"));
  assert.ok((await texts(page, "error-speed-0")).some((text) => text.includes("{/Symbol s}")));
  // The policy: what is put in by force does not load.
  assert.equal(await page.evaluate(() => new Promise((done) => {
    const image = new Image();
    image.onload = () => done("loaded");
    image.onerror = () => done("refused");
    image.src = "file:///usr/share/pixmaps/none.png";
  })), "refused");
  const forced = problems.splice(before);
  assert.ok(forced.every((problem) => problem.includes("none.png")), String(forced));
  assert.ok(forced.some((problem) => problem.includes("Content Security Policy")), String(forced));
  await equal_columns_are_folded(page);
  await page.context().close();
}

const browser = await chromium.launch({executablePath: chromium_path, args: flags});
try {
  const page = await open(browser, 1280, 900);
  const study = await page.$eval("#data", (data) => JSON.parse(data.textContent));
  await charts_are_there(page, study);
  await hovering_tells_settings(page, study);
  await pressing_a_mark_finds_its_row(page);
  await selectors_change_charts(page, study);
  await tables_sort_and_filter(page, study);
  await table_shows_what_was_chosen(page, study);
  await zooms_and_comes_back(page);
  await prints(page);
  await fits_a_phone(browser);
  await hostile_text_is_text(browser);
  assert.deepEqual(problems, []);
  // The page itself, twice: the listener hears.
  assert.ok(requests >= 2);
  console.log(`${study.points.length} points, ${hovers} hovers, ${requests} requests, none of them to elsewhere`);
} finally {
  await browser.close();
}
