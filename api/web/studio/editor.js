// The text area with the numbers of its lines.
const find = (id) => document.getElementById(id);
export const text = find("text");

export function number(faults = new Set()) {
  const count = text.value.split("\n").length;
  find("lines").replaceChildren(...Array.from({ length: count }, (_, k) => {
    const line = document.createElement("span");
    line.textContent = String(k + 1);
    line.classList.toggle("fault", faults.has(k + 1));
    return line;
  }));
  find("lines").scrollTop = text.scrollTop;
  numberMarked();
}

// Marks the numbers of the lines that are selected: a browser shows what is selected only where the text has the focus.
function numberMarked() {
  find("lines").querySelectorAll(".marked").forEach((each) => each.classList.remove("marked"));
  if (text.selectionStart === text.selectionEnd) return;
  const line = (at) => text.value.slice(0, at).split("\n").length;
  const some = [...find("lines").children].slice(line(text.selectionStart) - 1, line(text.selectionEnd));
  some.forEach((each) => each.classList.add("marked"));
}
document.addEventListener("selectionchange", numberMarked);

export function goTo(line) {
  const before = text.value.split("\n").slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
  const length = (text.value.split("\n")[line - 1] || "").length;
  select(before, before + length);
}

function select(begin, end) {
  text.focus();
  mark(begin, end);
}

// Selects a piece of the text, and leaves the focus where it is.
export function mark(begin, end) {
  text.setSelectionRange(begin, end);
  text.scrollTop = Math.max(0, (text.value.slice(0, begin).split("\n").length - 6) * 20);
  numberMarked();
}

// Puts a text in the place of another one that is nearly the same, and marks what is new.
export function replace(content) {
  const old = text.value;
  const shorter = Math.min(old.length, content.length);
  let [begin, behind] = [0, 0];
  while (begin < shorter && old[begin] === content[begin]) begin += 1;
  while (behind < shorter - begin && old[old.length - 1 - behind] === content[content.length - 1 - behind]) behind += 1;
  text.value = content;
  mark(begin, content.length - behind);
}
