// A link that holds a text, and the cell of a task, behind the `#` of the address, which a browser sends to no server:
// #text=…&cell=…, each the UTF-8 of a text, compressed (raw DEFLATE), in base64url without padding.
import { LONGEST_TEXT } from "./documents.js";
import { cellNameOf, partOf } from "./parts.js";
import { Refused } from "./service.js";

const LONGEST_LINK = 2 ** 16; // characters
const PIECE = 1024; // bytes that are inflated at once: to 1 MB at most

const refused = (detail) => new Refused({ detail });

async function packed(text) {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const letters = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

// What is inflated is counted while it comes, and no more of it is inflated once it is too long.
async function unpacked(key, value) {
  const broken = () => refused(`The link is broken: its ${key} cannot be read. Was all of it copied?`);
  const empty = () => refused(`The link holds no text: its ${key} is empty.`);
  if (!value) throw empty();
  if (!/^[\w-]*$/.test(value) || value.length % 4 === 1) throw broken();
  const bytes = Uint8Array.from(atob(value.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
  let at = 0;
  const pieces = new ReadableStream({
    pull(sink) {
      if (at >= bytes.length) return sink.close();
      return sink.enqueue(bytes.slice(at, (at += PIECE)));
    },
  }, { highWaterMark: 0 });
  const reader = pieces.pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  const decoder = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true });
  let text = "";
  try {
    for (let done = false; !done && text.length <= LONGEST_TEXT;) {
      const piece = await reader.read();
      done = piece.done;
      text += decoder.decode(piece.value, { stream: !done });
    }
  } catch {
    throw broken();
  }
  if (text.length > LONGEST_TEXT) {
    reader.cancel().catch(() => {}); // what is wrong with the rest is of no interest
    throw refused(`The ${key} in the link is too long: a text has up to ${LONGEST_TEXT} characters.`);
  }
  if (text.includes("\0")) throw refused(`The ${key} in the link is no text: it has a zero byte.`);
  if (!text.trim()) throw empty();
  return text;
}

// The link to a text, and to the text of its cell, if it has one that is open. Raises `Refused`.
export async function linkTo(text, cell) {
  if (!text.trim()) throw refused("There is no text that a link can hold.");
  const parts = [`text=${await packed(text)}`];
  if (cell !== null) parts.push(`cell=${await packed(cell)}`);
  const link = `${location.origin}${location.pathname}#${parts.join("&")}`;
  if (link.length > LONGEST_LINK)
    throw refused(`The link would have ${link.length} characters; up to ${LONGEST_LINK} are allowed. Save the text as a file.`);
  return link;
}

export const isLink = (hash) => /[#&](text|cell)=/.test(hash);

// What a link holds: { text, cell, file }. `cell` is null without a cell; `file` is what the text calls it. Raises `Refused`.
export async function heldBy(hash) {
  const held = new Map();
  for (const part of hash.slice(1).split("&")) {
    const [key, ...value] = part.split("=");
    if (!["text", "cell"].includes(key) || held.has(key))
      throw refused(`The link is broken: it has ${JSON.stringify(key.slice(0, 20))}; allowed: text and cell, each once.`);
    held.set(key, await unpacked(key, value.join("=")));
  }
  if (!held.has("text")) throw refused("The link is broken: it has a cell without a text.");
  const { text, cell = null } = Object.fromEntries(held);
  const file = cellNameOf(text);
  if (cell !== null && (file === null || partOf(cell) !== "cell"))
    throw refused("The link is broken: its cell is no cell of a task that it holds.");
  return { text, cell, file };
}
