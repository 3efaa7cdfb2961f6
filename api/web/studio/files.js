// How files and links come into the page and leave it.
import { kindOf } from "./documents.js";

const find = (id) => document.getElementById(id);
// A busy browser reads what is saved after the click: only then may its address be forgotten.
const SAVED_MS = 60_000;

// Calls `open` with the files that are dropped on a window.
export function receiveFiles(place, open) {
  const withFiles = (act) => (event) => {
    if (!event.dataTransfer.types.includes("Files")) return;
    event.preventDefault();
    act([...event.dataTransfer.files]);
  };
  place.addEventListener("dragover", withFiles(() => {}));
  place.addEventListener("drop", withFiles(open));
}

// Whether what is pasted into a text area is a document of its own, and no value of a key and no item of a list there.
export function isDocument(content, files, area) {
  const whole = area.selectionEnd - area.selectionStart === area.value.length;
  const value = !whole && /[:,[{-]\s*$/.test(area.value.slice(0, area.selectionStart));
  let found = { kind: "text" };
  try {
    found = content && !value ? kindOf(content) : found;
  } catch {
    if (!whole) return false; // it is part of another text
    found = { kind: "refused" };
  }
  return found.kind !== "text" || !(content || !files.length);
}

export function download(content, file) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type: "application/octet-stream" }));
  link.download = file;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), SAVED_MS);
}

// Copies a link to what it holds, or shows it where the browser does not let a page copy: where it is not served over
// HTTPS. What there is to say of it.
export async function offerLink(link, held) {
  try {
    await navigator.clipboard.writeText(link);
    return `The link is copied. It has ${link.length} characters and holds ${held} now.`;
  } catch {
    find("link").value = link;
    find("link-dialog").showModal();
    find("link").select();
    return "";
  }
}
