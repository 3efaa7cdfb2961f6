// What is drawn and where it is written: a place of the text and a thing of the drawing select each other.
import * as drawing from "./drawing.js";
import { text } from "./editor.js";
import { partOf } from "./parts.js";

let places = []; // of the text that is drawn: { kind, name, written, begin, end } of the service

export const shownAs = () => (partOf(text.value) === "cell" ? "cell" : "text");

export function know(found) {
  places = found;
  chooseAtCaret();
}

// Marks in the drawing what is written at the caret, or else in its line: the innermost.
export function chooseAtCaret() {
  const at = text.selectionStart;
  const here = places.filter(({ written }) => written === shownAs());
  const line = [text.value.lastIndexOf("\n", at - 1) + 1, (text.value + "\n").indexOf("\n", at)];
  const within = (from, to) => here.filter(({ begin, end }) => begin <= to && end >= from).sort((a, b) => a.end - a.begin - (b.end - b.begin));
  drawing.choose(within(at, at)[0] || within(...line)[0]);
}

// Where a body is written.
export function placeOf({ name, kind }) {
  const own = ["robot", "tool"].includes(kind) ? [kind, ""] : ["body", name];
  return places.find((each) => each.kind === own[0] && each.name === own[1]) || places.find((each) => each.kind === kind);
}
