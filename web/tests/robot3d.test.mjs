// The drawing in 3D: loaded when it is opened, turned, coloured, with bodies and meshes, quick, and left out without WebGL.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { folderOf } from "./command.mjs";
import { ARM, choose, identify, openFolds, openSite, openSpace, status, untilReady, visit } from "./site.mjs";
import { ball, zipOf } from "./surfaces.mjs";

/** Pictures a second at least, at 800 x 600 px without a graphics processor, where other work takes most of the processor. */
const SLOWEST = { boxes: 10, meshes: 4 };
/** Triangles of the mesh of each link, of which the measured robot has three. */
const TRIANGLES = 40e3;
/** Changed bytes of a picture that was turned, at least, as a part of all. */
const TURNED = 0.01;

let site;
before(async () => { site = await openSite(); });
after(() => site.close());

const canvas = (page) => page.getByRole("application", { name: /^The robot in 3D/ });

const pictureOf = async (page) => (await canvas(page).screenshot()).toString("base64");

/** The part of the drawing's points that an act changes. */
async function changeBy(page, act) {
  const before = await pictureOf(page);
  await act();
  await page.waitForTimeout(300);
  return page.evaluate(async (pictures) => {
    const points = async (base64) => {
      const image = new Image();
      image.src = `data:image/png;base64,${base64}`;
      await image.decode();
      const surface = new OffscreenCanvas(image.width, image.height).getContext("2d");
      surface.drawImage(image, 0, 0);
      return new Uint32Array(surface.getImageData(0, 0, image.width, image.height).data.buffer);
    };
    const [a, b] = await Promise.all(pictures.map(points));
    return a.filter((point, k) => point !== b[k]).length / a.length;
  }, [before, await pictureOf(page)]);
}

/** Pictures a second while a key turns the robot: each turn draws one. */
function rate(page) {
  return canvas(page).evaluate(async (element) => {
    const turn = () => element.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
    const begin = performance.now();
    let pictures = 0;
    for (; performance.now() - begin < 2000; pictures += 1) {
      turn();
      await new Promise(requestAnimationFrame);
    }
    return (1000 * pictures) / (performance.now() - begin);
  });
}

test("the arm in 3D: nothing is loaded before, robot, curves and values show one moment, and a result adds its residual and its bodies", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  const asked = [];
  page.on("request", (request) => asked.push(request.url()));
  await page.getByRole("button", { name: "Try the arm" }).click();
  await untilReady(page);
  assert.equal(asked.filter((url) => url.endsWith("robot3d.js")).length, 0);
  await openSpace(page);
  const lines = page.locator(".chart .moment");
  const before = await lines.first().getAttribute("d");
  const seek = () => page.getByRole("slider", { name: "Time" }).fill("120");
  assert.ok(await changeBy(page, seek) > 1e-3, "the robot moves");
  assert.equal(await lines.count(), 3);
  assert.notEqual(await lines.first().getAttribute("d"), before);
  await page.getByText(/^At \d+\.\d\d s$/).waitFor();
  await canvas(page).focus();
  assert.ok(await changeBy(page, () => page.keyboard.press("ArrowLeft")) > TURNED, "a key turns it");
  assert.ok(await changeBy(page, () => page.keyboard.press("+")) > TURNED, "a key zooms");
  const box = await canvas(page).boundingBox();
  const drag = async () => {
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 90, box.y + box.height / 2 + 20, { steps: 3 });
    await page.mouse.up();
  };
  assert.ok(await changeBy(page, drag) > TURNED, "a drag turns it");
  assert.ok(await changeBy(page, () => page.getByLabel("Colour").selectOption("none")) > 1e-3, "torques colour it");
  assert.equal(await page.getByLabel("Inertia identified, filled").count(), 0);
  await identify(page);
  await page.getByLabel("Inertia identified, filled").waitFor();
  await page.getByLabel("Colour").selectOption("residual");
  await page.getByText("3 times its root mean square").waitFor();
  assert.equal(await page.locator(".chart .curve.residual").count(), 3);
  assert.equal(await page.getByRole("columnheader", { name: "residual" }).count(), 1);
  for (const label of ["Inertia a priori, as wires", "Inertia identified, filled"]) {
    assert.ok(await changeBy(page, () => page.getByLabel(label).click()) > 1e-3, label);
  }
  await page.getByRole("button", { name: "Show flat" }).click();
  await page.getByRole("img", { name: "The robot as a stick figure" }).waitFor();
  assertQuiet();
});

/** The arm with four meshes, one of each format, and one that is not there. */
function describedArm() {
  const visual = (file) => `<visual><origin xyz="0 0 0.12"/><geometry><mesh filename="package://arm/meshes/${file}"/></geometry></visual>`;
  const meshes = { base: "base.glb", column: "column.stl", upper_arm: "upper_arm.obj", forearm: "forearm.dae", tool: "tool.stl" };
  return Object.entries(meshes).reduce(
    (urdf, [link, file]) => urdf.replace(new RegExp(`<link name="${link}"(/>|>)`), (_, end) => `<link name="${link}">${visual(file)}${end === "/>" ? "</link>" : ""}`),
    readFileSync(ARM, "utf8"),
  );
}

test("a zip with meshes of all formats: they are drawn, what is missing is listed, and boxes stand for it", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  const folder = folderOf(t, []);
  const files = { "arm/package.xml": "<package/>", "arm/urdf/arm.urdf": describedArm() };
  for (const [name, format] of Object.entries({ "base.glb": "glb", "column.stl": "stl", "upper_arm.obj": "obj", "forearm.dae": "dae" })) {
    files[`arm/meshes/${name}`] = ball(format, { radius: 0.09, triangles: 400 });
  }
  writeFileSync(join(folder, "arm.zip"), zipOf(files));
  await choose(page, "Choose robot", [join(folder, "arm.zip")]);
  await page.getByText("4 meshes").waitFor();
  await openSpace(page);
  await page.getByLabel("Meshes", { exact: true }).waitFor();
  await openFolds(page);
  assert.deepEqual(await page.locator(".missing li").allInnerTexts(), ["package://arm/meshes/tool.stl: drop this file on the page, or its folder"]);
  assert.ok(await changeBy(page, () => page.getByLabel("Meshes", { exact: true }).click()) > 1e-3, "the meshes are drawn");
  writeFileSync(join(folder, "tool.stl"), "no triangles");
  await choose(page, "Choose robot", [join(folder, "tool.stl")]);
  await page.getByText(/^package:\/\/arm\/meshes\/tool\.stl: (?!drop)/).waitFor();
  writeFileSync(join(folder, "tool.stl"), ball("stl", { radius: 0.05, triangles: 100 }));
  await choose(page, "Choose robot", [join(folder, "tool.stl")]);
  await page.locator(".missing").waitFor({ state: "detached" });
  await page.getByRole("button", { name: "Remove the meshes" }).click();
  await page.getByText("5 files of meshes not drawn; boxes stand for their links").waitFor();
  assertQuiet();
});

test("boxes and meshes are quick without a graphics processor", async (t) => {
  const { page, close } = await visit(site, { width: 1400 });
  t.after(close);
  const folder = folderOf(t, []);
  writeFileSync(join(folder, "arm.urdf"), describedArm());
  const links = ["column.stl", "upper_arm.obj", "forearm.dae"];
  for (const name of links) writeFileSync(join(folder, name), ball(name.split(".")[1], { radius: 0.12, triangles: TRIANGLES }));
  await choose(page, "Choose robot", [join(folder, "arm.urdf")]);
  await status(page).filter({ hasText: "Add the log" }).waitFor();
  await openSpace(page);
  const { width, height } = await canvas(page).boundingBox();
  const boxes = await rate(page);
  await choose(page, "Choose robot", links.map((name) => join(folder, name)));
  await page.getByLabel("Meshes", { exact: true }).waitFor();
  const meshes = await rate(page);
  t.diagnostic(`${width.toFixed(0)} x ${height.toFixed(0)} px: ${boxes.toFixed(0)} pictures a second of boxes, ${meshes.toFixed(0)} of meshes with ${links.length * TRIANGLES} triangles`);
  assert.ok(boxes > SLOWEST.boxes && meshes > SLOWEST.meshes, `${boxes}, ${meshes}`);
});

test("a broken zip is an error, and the page goes on", async (t) => {
  const { page, close } = await visit(site);
  t.after(close);
  const folder = folderOf(t, []);
  writeFileSync(join(folder, "arm.zip"), "PK no archive");
  await choose(page, "Choose robot", [join(folder, "arm.zip")]);
  await page.getByText("arm.zip: it is no zip archive").waitFor();
  await choose(page, "Choose robot", [ARM]);
  await status(page).filter({ hasText: "Add the log" }).waitFor();
});

test("without WebGL there is the flat drawing, and a line that says why", async (t) => {
  const { page, assertQuiet, close } = await visit(site, {
    prepare: () => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { return /^webgl/.test(kind) ? null : getContext.call(this, kind, ...rest); };
    },
  });
  t.after(close);
  await choose(page, "Choose robot", [ARM]);
  await page.getByText("This browser has no WebGL, so there is no drawing in 3D.").waitFor();
  await page.getByRole("img", { name: "The robot as a stick figure" }).waitFor();
  assert.equal(await page.getByRole("button", { name: "Show in 3D" }).count(), 0);
  assertQuiet();
});
