// What the pages' script does where a page has one, and that all is readable without it.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch, open, openFolds, pagesOf } from "./pages.mjs";
import { structureOf } from "./structure.mjs";

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

for (const { name, file } of pagesOf(process.env.PAGES)) {
  test(`${name}: readable without script`, () => readable(file));
  test(`${name}: what the script does`, async (t) => {
    const { page, complaints, close } = await open(browser, file);
    if (await page.locator("script").count() === 0) t.skip("the page has no script");
    await openFolds(page);
    await t.test("tables are sorted", (t) => tablesAreSorted(t, page));
    await t.test("tables are filtered and copied as CSV", (t) => tablesAreCopied(t, page));
    await t.test("figures zoom together", (t) => figuresZoom(t, page));
    await t.test("quiet", () => assert.deepEqual(complaints, []));
    await close();
  });
}

/** Without script everything shows, and there is no button that nothing listens to. */
async function readable(file) {
  const [plain, scripted] = await Promise.all([false, true].map((script) => open(browser, file, { script })));
  await openFolds(plain.page);
  const [without, all] = await Promise.all([plain, scripted].map(({ page }) => structureOf(page)));
  const hidden = await plain.page.evaluate(hiddenParts);
  const idle = await plain.page.locator("button:visible").count();
  await Promise.all([plain.close(), scripted.close()]);
  assert.deepEqual(without, all);
  assert.deepEqual(hidden, []);
  assert.equal(idle, 0, "buttons that nothing listens to");
}

/** Tables and drawings that do not show, runs in the page. */
function hiddenParts() {
  const parts = [...document.querySelectorAll("table, svg[role=img]")];
  return parts.filter((part) => !part.checkVisibility() || part.getBoundingClientRect().height === 0)
    .map((part) => part.outerHTML.slice(0, 120));
}

/** A table with buttons in its head is sorted by the last one, up and down, and loses no row. */
async function tablesAreSorted(t, page) {
  const tables = await page.locator("table", { has: page.locator("th button") }).all();
  if (tables.length === 0) t.skip("no table can be sorted");
  for (const table of ends(tables)) {
    const header = table.locator("th", { has: page.locator("button") }).last();
    const before = await table.evaluate(cellsBelow, await columnOf(header));
    for (const direction of ["ascending", "descending"]) {
      await header.locator("button").click();
      assert.equal(await header.getAttribute("aria-sort"), direction);
      const cells = await table.evaluate(cellsBelow, await columnOf(header));
      assert.deepEqual([...cells].sort(), [...before].sort(), "the same cells");
      const numbers = cells.map(numberIn).filter(Number.isFinite);
      const sign = direction === "ascending" ? 1 : -1;
      assert.deepEqual(numbers, [...numbers].sort((a, b) => sign * (a - b)));
    }
  }
}

/** The first and the last of the parts that share a script. */
function ends(parts) {
  return parts.length > 1 ? [parts[0], parts.at(-1)] : parts;
}

/** The place of a header's cells in their rows. */
function columnOf(header) {
  return header.evaluate((cell) => cell.cellIndex);
}

/** The texts of a column, runs in the page. */
function cellsBelow(table, column) {
  const rows = [...table.querySelectorAll("tbody tr")].filter((row) => !row.hidden && row.cells.length > column);
  return rows.map((row) => row.cells[column].textContent.trim());
}

function numberIn(text) {
  const found = /^[*+]?\s*(-?\d[\d.]*(?:e[-+]?\d+)?)/i.exec(text);
  return found ? Number(found[1]) : NaN;
}

/** What is copied has a line for the head and one for each row that shows, all with as many fields. */
async function tablesAreCopied(t, page) {
  await page.evaluate(recordCopies);
  const copiers = await page.getByRole("button", { name: /\bCSV\b/i }).all();
  if (copiers.length === 0) t.skip("no table can be copied");
  for (const copier of ends(copiers)) {
    const block = copier.locator("xpath=ancestor::*[.//table][1]");
    const filter = block.getByRole("searchbox");
    const filters = await filter.count() > 0;
    const whole = await block.locator("table").evaluate(rowsThatShow);
    const word = await block.locator("tbody tr", { has: page.locator("td") }).last().locator("th, td").first().innerText();
    if (filters) await filter.fill(word);
    const shown = await block.locator("table").evaluate(rowsThatShow);
    await copier.click();
    const lines = await page.evaluate(() => globalThis.copied.pop().trimEnd().split("\n"));
    assert.ok(shown > 0 && (!filters || shown < whole), `${shown} of ${whole} rows show with the filter ${word}`);
    assert.equal(lines.length, 1 + shown, "lines of the copy");
    const fields = lines.map((line) => line.match(/"(?:[^"]|"")*"|[^,]+/g).length);
    assert.deepEqual(fields, fields.map(() => fields[0]), "fields of each line");
    if (filters) await filter.fill("");
  }
}

/** Keeps what is copied, runs in the page. */
function recordCopies() {
  globalThis.copied = [];
  const clipboard = { writeText: async (text) => { globalThis.copied.push(text); } };
  Object.defineProperty(navigator, "clipboard", { value: clipboard });
}

/** Rows with data that show, runs in the page. */
function rowsThatShow(table) {
  const rows = [...table.querySelectorAll("tbody tr")];
  return rows.filter((row) => row.checkVisibility() && row.querySelector("td")).length;
}

/** The drawings of a figure zoom together, by button and by drag, and go back to the whole; the pointer shows values. */
async function figuresZoom(t, page) {
  const figures = await page.locator("figure", { has: page.getByRole("button", { name: /zoom in/i }) }).all();
  if (figures.length === 0) t.skip("no figure zooms");
  for (const figure of figures) {
    const reset = figure.getByRole("button", { name: /whole/i });
    await reset.click();
    const whole = await figure.evaluate(drawings);
    await figure.getByRole("button", { name: /zoom in/i }).click();
    const zoomed = await figure.evaluate(drawings);
    whole.forEach((drawing, i) => assert.notEqual(zoomed[i], drawing, "every drawing zooms"));
    await reset.click();
    assert.deepEqual(await figure.evaluate(drawings), whole);
    await hover(page, figure.locator("svg svg").first());
    await drag(page, figure.locator("svg svg").first());
    const dragged = await figure.evaluate(drawings);
    whole.forEach((drawing, i) => assert.notEqual(dragged[i], drawing, "every drawing follows the drag"));
    await reset.click();
  }
}

/** The labels of each drawing of a figure, runs in the page. */
function drawings(figure) {
  return [...figure.querySelectorAll("svg[role=img]")].map((drawing) => drawing.textContent);
}

/** The pointer on an element shows text that was not there. */
async function hover(page, element) {
  const text = () => page.evaluate(() => document.body.innerText);
  await page.mouse.move(0, 0);
  const before = await text();
  await element.hover();
  assert.notEqual(await text(), before, "values under the pointer");
}

/** Drags from a quarter to three quarters of an element. */
async function drag(page, element) {
  await element.scrollIntoViewIfNeeded();
  const { x, y, width, height } = await element.boundingBox();
  await page.mouse.move(x + width / 4, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + (3 * width) / 4, y + height / 2);
  await page.mouse.up();
}
