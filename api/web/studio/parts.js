// A scenario in two texts: a task, and the cell that it names by its file. The cell is one of the texts that are kept.
import { fileName, nameOf } from "./documents.js";
import * as drafts from "./drafts.js";
import { Refused } from "./service.js";

const SCHEMA = /^\{?\s*["']?schema["']?\s*:\s*["']?assur-(cell|task)\/1\b/m;
const FILE = /^\s*["']?cell["']?\s*:\s*\{?\s*["']?file["']?\s*:\s*(?:"([^"\n]*)"|'([^'\n]*)'|([^\s,}#]+))/m;

let within = null; // the id of the task in whose drawing the text of its cell is shown

const OF_SERVICE = /^shared\//; // files of shipped cells, as the tasks that are shipped name them

// "cell" or "task"; "scenario": the text is whole.
export const partOf = (text) => (SCHEMA.exec(text) || [null, "scenario"])[1];

// The name of the file of a text.
export const fileOf = ({ text, file }) => file || `${fileName(nameOf(text, file))}.yaml`;

// The name of the file that a task calls its cell; null: it calls none, or the text is no task.
export function cellNameOf(text) {
  if (partOf(text) !== "task") return null;
  const [, ...named] = FILE.exec(text) || [];
  return (named.find(Boolean) || "").split("/").pop() || null;
}

// The kept text that is the cell of a task; null: there is none, or the text is no task.
export function cellOf(text) {
  const wanted = cellNameOf(text);
  return wanted === null ? null : drafts.all().find((draft) => partOf(draft.text) === "cell" && fileOf(draft) === wanted) || null;
}

// From now on the text of a cell is shown in the drawing of this task; null: alone.
export function drawWithin(task) {
  within = task && task.id;
}

// The task in whose drawing a text is shown, which is its cell; null: it is shown alone, or is no cell.
export function taskOf(text) {
  const task = partOf(text) === "cell" ? drafts.all().find(({ id }) => id === within) : null;
  const cell = task ? cellOf(task.text) : null;
  return cell !== null && cell.id === (drafts.current() || {}).id ? task : null;
}

// The other one of the texts of a task and its cell; null: there is none.
export const besideOf = (text) => taskOf(text) || cellOf(text);

// What is drawn with a text: { text, cell }, the task and the text of its cell, whichever of them the text is. `cell` is
// null where there is none: the text is whole, a cell that is shown alone, or a task whose cell is not here.
export function drawnWith(text) {
  const task = taskOf(text);
  const cell = task ? { text } : cellOf(text);
  return { text: task ? task.text : text, cell: cell && cell.text };
}

// What the service is to read for a text. `shipped`: it is one of the service's own. Raises `Refused`
// for a task whose cell is not here: the name of its file is `missing`.
export function readable(text, shipped) {
  const drawn = drawnWith(text);
  if (drawn.cell !== null) return drawn;
  if (partOf(text) === "cell") return { cell: text };
  const named = FILE.exec(text);
  const value = named && named.slice(1).find(Boolean);
  if (shipped || partOf(text) !== "task" || named === null || OF_SERVICE.test(value)) return { text };
  const line = text.slice(0, named.index + named[0].length).split("\n").length;
  throw new Refused({ missing: cellNameOf(text), errors: [{ field: "cell.file", value, allowed: "the file of a cell that is open here: open it, too", line }] });
}
