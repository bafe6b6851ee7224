// Starts the page: one client, one state, one view of it.

import { render } from "preact";
import { App } from "./app";
import { Client } from "./client";
import { Keeper } from "./kept";
import { linkedIn } from "./link";
import { loadProgram, THREADS } from "./program";
import { EMPTY, type State } from "./state";
import { Page } from "./views/Page";

const root = document.getElementById("page")!;
const app = new App(new Client(loadProgram()), draw, new Keeper());

function draw(state: State): void {
  render(<Page state={state} app={app} />, root);
}

root.replaceChildren();
draw(EMPTY);
void app.begin(location.hash).then(forgetLink);
addEventListener("hashchange", () => {
  const linked = linkedIn(location.hash);
  if (linked !== null) void app.follow(linked).then(forgetLink);
});
// Results of the user's own files that were not saved: the browser asks before the page is left.
addEventListener("beforeunload", (event) => {
  if (app.state.isUnsaved) event.preventDefault();
});
if ("serviceWorker" in navigator && location.protocol.startsWith("http")) {
  void navigator.serviceWorker.register(THREADS > 1 ? "sw_threads.js" : "sw.js");
}

/** A link that was followed leaves the address, so that a reload finds what was done since. */
function forgetLink(): void {
  if (linkedIn(location.hash) !== null) history.replaceState(null, "", location.pathname + location.search);
}
