// What a reload of the same tab finds again: files, choices and results, in the browser's own storage of this page.

import type { State } from "./state";

/** The state without what only a running task has. */
type KeptState = Omit<State, "task" | "problem" | "said">;

/** What is kept of a tab, in two entries, as files are large and change seldom. */
interface Kept<T> {
  tab: string;
  /** When it was kept, ms. */
  at: number;
  content: T;
}

type Files = ReadonlyMap<string, Blob>;

const DATABASE = "thetahat";
const STORES = ["states", "files"] as const;
type StoreName = (typeof STORES)[number];
const TAB = "thetahat-tab";
/** What tabs that were closed have left is removed after a day, ms. */
const OUTDATED = 24 * 3600 * 1000;
/** Pause after a change before it is kept, ms. */
const PAUSE = 200;

/** Keeps the state of this tab. Without storage, as in some private windows, nothing is kept, and nothing fails. */
export class Keeper {
  private timer: ReturnType<typeof setTimeout> | undefined;
  private readonly tab = tabOf();
  private database: Promise<IDBDatabase> | null = null;
  /** The files that are kept. */
  private files: Files = new Map();

  /** Keeps a state once it rests; an empty one is forgotten. */
  keep(state: State, files: Files): void {
    clearTimeout(this.timer);
    if (state.task) return;
    this.timer = setTimeout(() => void this.write(state, files).catch(() => {}), PAUSE);
  }

  /** What was kept of this tab before its reload. */
  async find(): Promise<{ state: State; files: Files } | null> {
    try {
      for (const name of STORES) await forgetOutdated(await this.store(name));
      const [state, files] = [await this.read<KeptState>("states"), await this.read<Files>("files")];
      this.files = files ?? new Map();
      return state && { state: { ...state, task: null, problem: null, said: "" }, files: this.files };
    } catch {
      return null;
    }
  }

  private async write({ task: _, problem: __, said: ___, ...state }: State, given: Files): Promise<void> {
    const files = new Map(given);
    const isEmpty = state.files.length === 0 && state.experiment === null;
    if (!isSame(files, this.files)) {
      await this.put("files", files.size === 0 ? null : files);
      this.files = files;
    }
    await this.put<KeptState>("states", isEmpty ? null : state);
  }

  private async read<T>(name: StoreName): Promise<T | null> {
    const record = (await done((await this.store(name)).get(this.tab))) as Kept<T> | undefined;
    return record?.content ?? null;
  }

  /** Puts the entry of this tab; null removes it. */
  private async put<T>(name: StoreName, content: T | null): Promise<void> {
    const records = await this.store(name);
    if (content === null) await done<undefined>(records.delete(this.tab));
    else await done<IDBValidKey>(records.put({ tab: this.tab, at: Date.now(), content } satisfies Kept<T>));
  }

  private async store(name: StoreName): Promise<IDBObjectStore> {
    this.database ??= open();
    return (await this.database).transaction(name, "readwrite").objectStore(name);
  }
}

function isSame(a: Files, b: Files): boolean {
  return a.size === b.size && [...a].every(([path, file]) => b.get(path) === file);
}

/** The name of this tab, which lives as long as the tab. */
function tabOf(): string {
  const fresh = String(Math.random()).slice(2);
  try {
    const own = sessionStorage.getItem(TAB) ?? fresh;
    sessionStorage.setItem(TAB, own);
    return own;
  } catch {
    return fresh;
  }
}

function open(): Promise<IDBDatabase> {
  const opening = indexedDB.open(DATABASE, 1);
  opening.onupgradeneeded = () => {
    for (const name of STORES) opening.result.createObjectStore(name, { keyPath: "tab" }).createIndex("at", "at");
  };
  return done<IDBDatabase>(opening);
}

async function forgetOutdated(records: IDBObjectStore): Promise<void> {
  const outdated = await done<IDBValidKey[]>(records.index("at").getAllKeys(IDBKeyRange.upperBound(Date.now() - OUTDATED)));
  for (const tab of outdated) records.delete(tab);
}

function done<T>(request: IDBRequest<T>): Promise<T> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}
