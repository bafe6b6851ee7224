// Which files of folders and archives are taken.

import type { GivenFile } from "./app";
import { SessionError } from "./client";
import { extensionOf, MESHES } from "./meshes";
import { unzipped } from "./zip";

/** Ends of names that choosers offer. */
export const ROBOTS = `.urdf,.xml,.toml,.zip,${MESHES}`;
export const LOGS = ".csv,.tsv,.txt,.dat,.npy,.npz,.mat,.h5,.hdf5,.parquet,.db3,.mcap,.bag,.zst,.zstd,.toml";

/** What the folder of a robot holds next to it. */
const OTHERS = ["package.xml", "cmakelists.txt", "readme.txt", "license.txt"];
const KNOWN = new Set([...ROBOTS.split(","), ...LOGS.split(","), ".xacro", ".bin"].filter((end) => end !== ".zip"));

/** Whether a file of a folder or an archive may be one of the robot, its meshes or its logs. */
export function isUseful(path: string): boolean {
  const name = path.toLowerCase().replace(/^.*\//, "");
  return KNOWN.has(`.${extensionOf(name)}`) && !name.startsWith(".") && !OTHERS.includes(name);
}

/** The files, those of archives in their place. */
export async function withoutArchives(given: GivenFile[]): Promise<GivenFile[]> {
  const all = await Promise.all(given.map((one) => (extensionOf(one.path) === "zip" ? unpacked(one) : [one])));
  return all.flat();
}

async function unpacked({ path, file }: GivenFile): Promise<GivenFile[]> {
  try {
    return await unzipped(file, isUseful);
  } catch (error) {
    throw new SessionError(`${path}: ${error instanceof Error ? error.message : String(error)}`);
  }
}
