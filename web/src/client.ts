// The page's side of the worker and its threads: calls with answers, and a new worker after one was cancelled or has stopped.

import type { FromWorker, Method, SampleName, ToWorker } from "./contract";
import { isMesh } from "./meshes";
import { THREADS, type Program } from "./program";

/** An error with the message of the command line. */
export class SessionError extends Error {}
/** The person cancelled. */
export class Cancelled extends Error {}
/** The program stopped in the middle of its work. */
export class Trapped extends Error {}
/** A thread of the program stopped: its call is restarted with one thread. */
class ThreadStopped extends Error {}

interface Pending {
  resolve: (answer: string) => void;
  reject: (error: Error) => void;
  stage: (text: string) => void;
}

export class Client {
  private worker: Promise<Worker> | null = null;
  private running: Worker | null = null;
  private helpers: Worker[] = [];
  /** One after a thread has stopped or could not start, for example for lack of memory. */
  private threads = THREADS;
  /** Why the worker before this one was ended. */
  private reason: Error = new Cancelled();
  private readonly pending = new Map<number, Pending>();
  /** The files that a new worker gets again. */
  private readonly files = new Map<string, Blob>();
  private sampled: SampleName | null = null;
  private calls = 0;

  constructor(private readonly program: Promise<Program>) {}

  /** Puts a file in the session's folder; a mesh stays on the page. */
  async put(path: string, file: Blob): Promise<void> {
    if (!isMesh(path)) await this.call("put", [path, file]);
    this.files.set(path, file);
  }

  async remove(path: string): Promise<void> {
    this.files.delete(path);
    if (!isMesh(path)) await this.call("remove", [path]);
  }

  /** The answer of a sample, whose files are the session's own. */
  async sample(name: SampleName): Promise<string> {
    const answer = await this.call("sample", [name]);
    this.sampled = name;
    return answer;
  }

  /** Gives the first worker the files of a visit before. */
  restore(files: ReadonlyMap<string, Blob>, sample: SampleName | null): void {
    for (const [path, file] of files) this.files.set(path, file);
    this.sampled = sample;
  }

  /** The files that were put. */
  get given(): ReadonlyMap<string, Blob> {
    return this.files;
  }

  /** Forgets all files. */
  clear(): void {
    this.files.clear();
    this.sampled = null;
    this.stop(new Cancelled());
  }

  /** Calls a method; stages of its progress come while it runs. Files are given as their bytes. */
  async call(method: Method, args: unknown[], stage: (text: string) => void = () => {}): Promise<string> {
    try {
      this.worker ??= this.start();
      return await this.send(await this.worker, method, args, stage);
    } catch (error) {
      if (!(error instanceof ThreadStopped)) throw error;
      const onOne = (text: string) => stage(`${text}; on one thread, as another one stopped (${error.message})`);
      onOne("restarted");
      return this.call(method, args, onOne);
    }
  }

  /** Ends the running call; the next one starts a new worker with the same files. */
  cancel(): void {
    this.stop(new Cancelled());
  }

  private async start(): Promise<Worker> {
    const program = await this.program;
    const worker = new Worker(program.script);
    this.running = worker;
    worker.addEventListener("message", ({ data }: MessageEvent<FromWorker>) => {
      if (worker !== this.running) return;
      if ("memory" in data) this.help(program, data.memory);
      else this.receive(data);
    });
    worker.addEventListener("error", (event) => worker === this.running && this.stop(new Trapped(event.message)));
    worker.postMessage({ module: program.module, threads: this.threads } satisfies ToWorker);
    if (this.sampled) await this.send(worker, "sample", [this.sampled]);
    for (const put of this.files) if (!isMesh(put[0])) await this.send(worker, "put", put);
    return worker;
  }

  /** Starts the threads of the session whose memory this is. */
  private help({ script, module }: Program, memory: WebAssembly.Memory): void {
    this.helpers = Array.from({ length: this.threads }, () => new Worker(script));
    for (const helper of this.helpers) {
      const stopped = (message: string) => {
        if (!this.helpers.includes(helper)) return;
        this.threads = 1;
        this.stop(new ThreadStopped(message));
      };
      helper.addEventListener("message", ({ data }: MessageEvent<{ trap: string }>) => stopped(data.trap));
      helper.addEventListener("error", (event) => stopped(event.message));
      helper.postMessage({ module, memory } satisfies ToWorker);
    }
  }

  private async send(worker: Worker, method: Method, given: unknown[], stage = (_: string) => {}): Promise<string> {
    const args = await Promise.all(given.map((arg) => (arg instanceof Blob ? bytesOf(arg) : arg)));
    return new Promise((resolve, reject) => {
      if (worker !== this.running) return reject(this.reason);
      const call = ++this.calls;
      this.pending.set(call, { resolve, reject, stage });
      const buffers = args.filter((arg) => arg instanceof Uint8Array).map((bytes) => bytes.buffer);
      worker.postMessage({ call, method, args } satisfies ToWorker, buffers);
    });
  }

  private receive(message: Exclude<FromWorker, { memory: WebAssembly.Memory }>): void {
    if ("trap" in message) return this.stop(new Trapped(message.trap));
    const pending = this.pending.get(message.call);
    if (!pending) return;
    if ("stage" in message) return pending.stage(message.stage);
    this.pending.delete(message.call);
    if ("error" in message) pending.reject(new SessionError(message.error));
    else pending.resolve(message.answer);
  }

  private stop(reason: Error): void {
    for (const worker of [this.running, ...this.helpers]) worker?.terminate();
    this.running = null;
    this.helpers = [];
    this.worker = null;
    this.reason = reason;
    const pending = [...this.pending.values()];
    this.pending.clear();
    for (const call of pending) call.reject(reason);
  }
}

async function bytesOf(file: Blob): Promise<Uint8Array<ArrayBuffer>> {
  return new Uint8Array(await file.arrayBuffer());
}
