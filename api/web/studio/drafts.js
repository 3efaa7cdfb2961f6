// The texts that are written here, kept in the storage of the browser until their writer deletes them.
//
// Each text has a record of its own. A tab writes a record only where it is as this tab wrote or read it last; where
// another tab has written since, the text of this tab goes on in a record of its own. So no tab overwrites another's.
import { local, session } from "./storage.js";

const PREFIX = "assur-text-";
const HERE = "assur-text";

let here = null; // the record of the text in this tab; null: it has none
let known = null; // that record as this tab wrote or read it last

function parsed(id, raw) {
  try {
    const { text, file = null, crlf = false, when = 0 } = JSON.parse(raw);
    return typeof text === "string" ? { id, text, file, crlf, when } : null;
  } catch {
    return null; // not ours
  }
}

function attach(id, raw) {
  [here, known] = [id, raw];
  if (id === null) session.remove(HERE);
  else session.write(HERE, id);
}

export const current = () => (here === null ? null : parsed(here, known));

// All records, the latest first.
export function all() {
  return local.keys()
    .filter((key) => key.startsWith(PREFIX))
    .map((key) => parsed(key.slice(PREFIX.length), local.read(key)))
    .filter((draft) => draft !== null)
    .sort((a, b) => b.when - a.when);
}

// The text in this tab goes on in this record (null: in none until it is kept). Returns it, null if there is none.
export function open(id) {
  const raw = id === null ? null : local.read(PREFIX + id);
  const draft = raw === null ? null : parsed(id, raw);
  attach(draft && id, draft && raw);
  return draft;
}

// What a page begins with: the text of this tab, else the latest one, else null.
export function begin() {
  return open(session.read(HERE)) || open((all()[0] || { id: null }).id);
}

// Keeps a text. Returns "kept", "parted" where it goes on in a record of its own because another tab wrote the one that
// they shared, or "lost" where the browser does not keep it.
export function keep(text, { file, crlf } = current() || {}) {
  const parted = here !== null && local.read(PREFIX + here) !== known;
  const id = here === null || parted ? `${Date.now().toString(36)}-${Math.random().toString(36).slice(2, 8)}` : here;
  const raw = JSON.stringify({ text, file, crlf, when: Date.now() });
  if (!local.write(PREFIX + id, raw)) return "lost";
  attach(id, raw);
  return parted ? "parted" : "kept";
}

// Writes another text into a record, which has the text `from`. Whether it is written: not where another tab has changed
// the record, or the browser does not keep it.
export function rewrite(id, from, to) {
  const draft = parsed(id, local.read(PREFIX + id));
  if (draft === null || draft.text !== from) return false;
  const raw = JSON.stringify({ text: to, file: draft.file, crlf: draft.crlf, when: Date.now() });
  if (!local.write(PREFIX + id, raw)) return false;
  if (id === here) attach(id, raw);
  return true;
}

export function remove() {
  local.remove(PREFIX + here);
  attach(null, null);
}

// Calls `shared` when another tab has written the record of this tab, and `others` when it has written any.
export function watch(shared, others) {
  addEventListener("storage", ({ key, newValue }) => {
    if (key === null || !key.startsWith(PREFIX)) return;
    if (key === PREFIX + here && newValue !== known) {
      if (newValue === null) attach(null, null); // its writer deleted it
      else shared();
    }
    others();
  });
}
