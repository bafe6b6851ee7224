// Starts the page: one client, one state, one view of it.

import { render } from "preact";
import { App } from "./app";
import { Client } from "./client";
import { loadProgram, THREADS } from "./program";
import { EMPTY, type State } from "./state";
import { Page } from "./views/Page";

const root = document.getElementById("page")!;
const app = new App(new Client(loadProgram()), draw);

function draw(state: State): void {
  render(<Page state={state} app={app} />, root);
}

root.replaceChildren();
draw(EMPTY);
if ("serviceWorker" in navigator && location.protocol.startsWith("http")) {
  void navigator.serviceWorker.register(THREADS > 1 ? "sw_threads.js" : "sw.js");
}
