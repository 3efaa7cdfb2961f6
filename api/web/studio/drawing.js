// The drawing of the cell that the text means, before any plan: one player for as long as the page is open.
import { ask } from "./service.js";

const find = (id) => document.getElementById(id);
let player = null; // null: it has not come, or this browser cannot draw
let drawn = null; // what is drawn, or will be once there is a player: { view, still, alone }

// Loads the player. `framed` is called with its window, `picked` with a body that is clicked, `moved` with what is dragged.
export async function begin(framed, picked, moved) {
  if (find("drawing").querySelector("iframe")) return;
  const frame = document.createElement("iframe");
  frame.title = "The cell at its start";
  frame.srcdoc = await (await ask("studio/player.html")).text();
  const loaded = new Promise((resolve) => frame.addEventListener("load", resolve, { once: true }));
  find("drawing").append(frame);
  await loaded;
  player = frame.contentWindow.assur || null;
  framed(frame.contentWindow);
  if (player !== null) Object.assign(player, { picked, moved });
  if (drawn !== null) show(drawn.view, drawn.still, drawn.alone);
}

// Nothing is drawn. The reason is shown in the place of the picture.
export function leave(why) {
  drawn = null;
  mark("");
  find("drawn").textContent = "";
  find("absent").textContent = why;
}

// Draws a view. `still`: the camera stays where it is; `alone`: it is of a cell without a task.
export function show(view, still, alone) {
  drawn = { view, still, alone };
  find("drawn").textContent = alone ? "without a task: somewhere within its limits" : "at its start, without a plan";
  mark("");
  find("absent").textContent = "";
  if (player !== null) player.take(view, still);
}

// Marks what is written at a place of the text: { kind, name } of the service, nothing for none.
export function choose(place) {
  if (player !== null && drawn !== null) player.mark(place);
}

// Why the cell that is drawn is not that of the text; nothing: it is.
export function mark(why) {
  find("undrawn").textContent = why;
}

// It is not shown beside an answer to the same text.
export function settle(answered) {
  const absent = find("absent").textContent !== "";
  find("absent").hidden = !absent;
  find("drawing").querySelectorAll("iframe").forEach((frame) => (frame.hidden = absent));
  find("drawing").hidden = answered || !(absent || (drawn !== null && player !== null));
}
