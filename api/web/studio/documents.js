// What a text is that comes from a file or the clipboard, and the text of a scenario for a request.
import { Refused } from "./service.js";

const MOST_BYTES = 64 * 2 ** 20; // of a plan file
export const LONGEST_TEXT = 2 ** 20; // characters in the editor
const LONGEST_NAME = 48;
const TAKEN = "The studio takes a scenario, a cell and a task (YAML or JSON), a request (JSON) and a plan file (JSON).";

// The content of a file. Raises `Refused` for one that is no text.
export async function contentOf(file) {
  const refused = (why) => new Refused({ detail: `${file.name} ${why}. ${TAKEN}` });
  if (!/(^[^.]+|\.(ya?ml|json|txt))$/i.test(file.name)) throw refused("has the name of another kind of file");
  if (file.size > MOST_BYTES) throw refused(`has ${file.size} bytes; up to ${MOST_BYTES} are allowed`);
  let text;
  try {
    text = new TextDecoder("utf-8", { fatal: true }).decode(await file.arrayBuffer());
  } catch {
    throw refused("is no text in UTF-8, or cannot be read");
  }
  if (text.includes("\0")) throw refused("is no text: it has a zero byte");
  return text;
}

// How many keys a JSON value has, and how many its text has: fewer where one is given twice.
function keysOf(value) {
  if (value === null || typeof value !== "object") return 0;
  const inside = Object.values(value).reduce((sum, each) => sum + keysOf(each), 0);
  return inside + (Array.isArray(value) ? 0 : Object.keys(value).length);
}
const STRING = /"(?:[^"\\]|\\.)*"(\s*:)?/g;
const keysIn = (text) => [...text.matchAll(STRING)].filter(([, colon]) => colon).length;
// Whole numbers that a browser would change.
const tooLong = (text) => (text.replace(STRING, "").match(/(?<![\d.eE+-])-?\d{16,}(?![\d.eE])/g) || [])
  .find((digits) => String(BigInt(Number(digits))) !== digits);

// What a text is: { kind: "text" } for what is left as it is written, { kind: "request", request } or { kind: "plan",
// request, plan, title, about }. Raises `Refused` for what the studio can name and does not take.
export function kindOf(text) {
  const refused = (what) => new Refused({ detail: `This is ${what}. ${TAKEN}` });
  if (/^\s*<robot\b|^\s*<\?xml[^]*<robot\b/.test(text)) throw refused("a robot description in URDF");
  if (/^\s*<(!doctype html|html)/i.test(text)) throw refused("a web page; the plan file of a report has its plan");
  if (/^\s*</.test(text)) throw refused("XML");
  const written = () => {
    if (text.length > LONGEST_TEXT) throw refused(`a text of ${text.length} characters, too long for a scenario`);
    return { kind: "text" };
  };
  if (!/^\s*[{[]/.test(text)) return written();
  let document;
  try {
    document = JSON.parse(text);
  } catch {
    return written(); // YAML may begin so; the service says what is wrong, with the line
  }
  if (Array.isArray(document)) throw refused(`a list of ${document.length} in JSON`);
  const { schema, request, plan } = document;
  const given = (value) => value !== null && typeof value === "object";
  if (/^assur-plan\//.test(schema) || (given(request) && given(plan))) {
    if (!given(request)) throw refused("a plan file without its request");
    if (!given(plan)) throw refused("a plan file without its plan");
    const { title = "", about = "" } = document;
    return { kind: "plan", request, plan, title: String(title), about: String(about) };
  }
  if (document.status !== undefined || document.certificate !== undefined)
    throw refused("an answer without its request; a plan file (assur plan --out) holds both");
  if (given(request) || /^assur-(cell|task)\//.test(schema)) return written(); // in JSON, which is YAML, too
  if (schema === undefined ? document.robot && document.task : /^assur\//.test(schema)) {
    if (keysIn(text) !== keysOf(document)) throw refused("a request that has a key twice");
    if (tooLong(text)) throw refused(`a request with ${tooLong(text)}, which has more digits than a browser keeps`);
    return { kind: "request", request: document };
  }
  const keys = Object.keys(document).slice(0, 5).join(", ");
  const holds = keys ? `the keys ${keys}` : "no key";
  throw refused(schema === undefined ? `JSON with ${holds}` : `a document of the schema ${JSON.stringify(schema)}`);
}

// ---- YAML -------------------------------------------------------------------------------------------------------

const WIDTH = 100;
const MEANS_MORE = /^(y|n|on|off|yes|no|true|false|null)$/i; // words that YAML may read as something else
const word = (text) => (/^[A-Za-z][\w./-]*$/.test(text) && !MEANS_MORE.test(text) ? text : JSON.stringify(text));

function inLine(value) {
  if (typeof value === "string") return word(value);
  if (value === Infinity || value === -Infinity) return `${value < 0 ? "-" : ""}1e999`; // the service refuses it, with its field
  if (value === null || typeof value !== "object") return JSON.stringify(value);
  if (Array.isArray(value)) return `[${value.map(inLine).join(", ")}]`;
  return `{${Object.entries(value).map(([key, each]) => `${word(key)}: ${inLine(each)}`).join(", ")}}`;
}

function block(value, indent) {
  const line = inLine(value);
  if (value === null || typeof value !== "object" || indent.length + line.length < WIDTH) return ` ${line}`;
  const below = `${indent}  `;
  const lines = Array.isArray(value)
    ? value.map((each) => `${indent}- ${block(each, below).trimStart()}`)
    : Object.entries(value).map(([key, each]) => `${indent}${word(key)}:${block(each, below)}`);
  return `\n${lines.join("\n")}`;
}

export function scenarioOf(request, about) {
  const lines = Object.entries(request).map(([key, value]) => `  ${word(key)}:${block(value, "    ")}`);
  return `about: ${JSON.stringify(about)}\nrequest:\n${lines.join("\n")}\n`;
}

// ---- names ------------------------------------------------------------------------------------------------------

// What a text is called: as its file, else by the first words of its `about`, also where it is no YAML yet.
export function nameOf(text, file) {
  if (file) return file.replace(/\.[^.]*$/, "") || file;
  const [, about = ""] = /^[{ \t]*["']?about["']?[ \t]*:[ \t]*(?:[>|][^\n]*\n\s*)?["']?([^\n"]*)/m.exec(text) || [];
  const first = about.split(/[.:;](?:\s|$)/)[0].trim();
  if (first.length <= LONGEST_NAME) return first || "own text";
  return first.slice(0, LONGEST_NAME + 1).replace(/\s+\S*$/, "").slice(0, LONGEST_NAME);
}

export const fileName = (name) => name.replace(/[^\p{L}\p{N}._-]+/gu, "-").replace(/^[-.]+|-+$/g, "") || "scenario";
