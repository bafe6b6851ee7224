// The states of the page in the order in which one window goes through them.

import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { ARM, choose, identify, openSpace, status, takeDemo } from "./site.mjs";

export const STATES = {
  empty: async () => {},
  robot: async (page) => {
    await choose(page, "Choose robot", [ARM]);
    await status(page).filter({ hasText: "Add the log" }).waitFor();
  },
  broken: async (page, folder) => {
    const file = join(folder, "broken.csv");
    writeFileSync(file, "time,q1,tau1\n0,1,2\n1,2\n2,3,4\n");
    await choose(page, "Choose logs", [file]);
    await page.getByRole("alert").waitFor();
  },
  columns: async (page, folder) => {
    const file = join(folder, "nameless.csv");
    const rows = Array.from({ length: 500 }, (_, k) => [k / 100, ...[1, 2, 3, 4, 5, 6].map((j) => Math.sin(k / (9 + j)))].join(","));
    writeFileSync(file, ["a,b,c,d,e,f,g", ...rows].join("\n"));
    await page.getByRole("button", { name: "Remove broken.csv" }).click();
    await choose(page, "Choose logs", [file]);
    await status(page).filter({ hasText: "Say which columns are which" }).waitFor();
  },
  understood: (page) => takeDemo(page),
  working: async (page) => {
    await page.getByRole("button", { name: "Identify" }).click();
    await page.getByRole("button", { name: "Cancel" }).waitFor();
  },
  cancelled: async (page) => {
    await page.getByRole("button", { name: "Cancel" }).click();
    await status(page).filter({ hasText: "Cancelled." }).waitFor();
  },
  result: async (page) => {
    await identify(page);
    await page.frameLocator("iframe").getByRole("region", { name: "Verdict" }).waitFor();
  },
  space: async (page) => {
    await openSpace(page);
    await page.getByLabel("Inertia identified, filled").waitFor();
    await page.getByRole("slider", { name: "Time" }).fill("150");
  },
  exported: async (page) => {
    await page.getByRole("button", { name: "MJCF", exact: true }).click();
    await page.getByRole("region", { name: "Remarks on the export" }).waitFor();
  },
};
