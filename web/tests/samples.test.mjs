// The samples of the first view, and links to their settings.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { identify, openFolds, openSite, status, untilReady, visit } from "./site.mjs";

let site;
before(async () => { site = await openSite(); });
after(() => site.close());

const text = (page) => page.getByRole("textbox", { name: "experiment.toml" }).inputValue();

test("the result of the demo is there without a click, and so are the links", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  const preview = page.getByRole("region", { name: "The result of the demo" });
  assert.match(await preview.innerText(), /zz1r\s+1\.25\s+1\.2\d+ ± 0\.\d+\s+kg m\^2/);
  await page.getByText(/The result of the demo: good\./).waitFor();
  for (const name of ["How to use this page", "Documentation", "Source", "Changes"]) {
    assert.match(await page.getByRole("link", { name }).getAttribute("href"), /^https:\/\/github\.com\//);
  }
  await page.getByRole("contentinfo").getByText(/^thetahat \d+\.\d+\.\d+/).waitFor();
  assertQuiet();
});

for (const [button, joints] of [["Try the arm", 3], ["Try the axis", 1]]) {
  test(`${button}: it goes the whole way`, async (t) => {
    const { page, assertQuiet, close } = await visit(site);
    t.after(close);
    await page.getByRole("button", { name: button }).click();
    await untilReady(page);
    assert.equal(await page.locator(".record .chart").count(), joints);
    assert.match(await identify(page), /^Verdict: (good|use with care)/);
    assertQuiet();
  });
}

test("the faulty log: its finding has a button, and what it changed stands beside the report before", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await page.getByRole("button", { name: "Try the faulty log" }).click();
  await untilReady(page);
  const findings = page.getByRole("list", { name: "Findings" });
  await findings.getByText("if the torques of joints 1 and 2 are exchanged").waitFor();
  assert.match(await identify(page), /^Verdict: do not use/);
  await page.getByRole("list", { name: "Remedies" }).getByRole("button", { name: /^Exchange the torques/ }).click();
  const change = page.getByRole("region", { name: /^Change by: Exchange/ });
  await change.waitFor({ timeout: 120_000 });
  assert.match(await change.innerText(), /verdict +good, before do-not-use\s+unseen error +0\.\d+ %, before 1\d\d %/);
  await page.getByText("The report before").click();
  await page.frameLocator('iframe[title="The report before"]').getByRole("region", { name: "Verdict" }).waitFor();
  const said = await page.locator("main").innerText();
  assert.doesNotMatch(said.replace(await text(page), ""), /--apply|thetahat identify/);
  assertQuiet();
});

test("a link gives the sample and the settings, and no data", async (t) => {
  const { page, context, assertQuiet, close } = await visit(site);
  t.after(close);
  await page.getByRole("button", { name: "Try the arm" }).click();
  await untilReady(page);
  await openFolds(page);
  await page.getByLabel("Window to, s").fill("9");
  await page.keyboard.press("Tab");
  await page.getByRole("button", { name: "Link to these settings" }).click();
  const link = await page.getByLabel(/^Copied/).inputValue();
  assert.match(link, /#sample=arm&settings=/);
  assert.ok(link.length < 300, link);
  const other = await context.newPage();
  await other.goto(link);
  await untilReady(other);
  await openFolds(other);
  assert.match(await text(other), /^window_end_s = 9$/m);
  assert.equal(new URL(other.url()).hash, "", "a reload finds what was done since");
  assertQuiet();
});

test("settings of a link without a sample are those of the files that are added", async (t) => {
  const settings = encodeURIComponent(JSON.stringify({ position_unit: "deg" }));
  const { page, close } = await visit(site, { address: `${site.url}#settings=${settings}` });
  t.after(close);
  await status(page).filter({ hasText: "The settings of the link are used" }).waitFor();
  await page.getByRole("button", { name: "Without them" }).click();
  assert.equal(await page.getByText("The settings of the link are used").filter({ visible: true }).count(), 0);
});

test("a damaged link says so", async (t) => {
  for (const [fragment, said] of [["sample=%3Cscript%3E", "names a sample that this page does not have"], ["settings=%7B%22rate", "it may have been cut"], ["settings=%7B%22robot%22%3A%22x%22%7D", "cannot be read"]]) {
    const { page, assertQuiet, close } = await visit(site, { address: `${site.url}#${fragment}` });
    t.after(close);
    await page.getByRole("alert").filter({ hasText: said }).waitFor();
    assertQuiet();
  }
});
