// What differs between two answers and the texts that they answer: a table for people.

const MOST_LINES = 20; // changed lines of a text that the table shows
const MOST_PAIRS = 4e6; // of lines that are compared with each other; longer texts differ as a whole between equal ends

// The lines of a text, or of the text of a task and that of its cell.
function linesOf(text) {
  let texts = [text];
  try {
    texts = JSON.parse(text).filter((each) => each !== null);
  } catch { /* one text */ }
  return texts.flatMap((each) => String(each).split("\n"));
}

// The lines that only the first text has, and those that only the second has.
export function changedLines(first, second) {
  const [a, b] = [linesOf(first), linesOf(second)];
  while (a.length && b.length && a[0] === b[0]) [a.shift(), b.shift()];
  while (a.length && b.length && a.at(-1) === b.at(-1)) [a.pop(), b.pop()];
  if (a.length * b.length > MOST_PAIRS) return [a, b];
  // lengths of the longest common sequences of what is left from i and j on
  const common = Array.from({ length: a.length + 1 }, () => new Uint32Array(b.length + 1));
  for (let i = a.length - 1; i >= 0; i -= 1) {
    for (let j = b.length - 1; j >= 0; j -= 1) {
      common[i][j] = a[i] === b[j] ? common[i + 1][j + 1] + 1 : Math.max(common[i + 1][j], common[i][j + 1]);
    }
  }
  const [gone, come] = [[], []];
  let [i, j] = [0, 0];
  while (i < a.length || j < b.length) {
    if (i < a.length && j < b.length && a[i] === b[j]) [i, j] = [i + 1, j + 1];
    else if (j === b.length || (i < a.length && common[i + 1][j] >= common[i][j + 1])) gone.push(a[i++]);
    else come.push(b[j++]);
  }
  return [gone, come];
}

const shown = (lines) => {
  const more = lines.length - MOST_LINES;
  return [...lines.slice(0, MOST_LINES), ...(more > 0 ? [`… ${more} more`] : [])].join("\n") || "–";
};

const result = ({ status, reason }) => (status === "planned" ? "planned" : `not planned, ${reason}`);
const duration = (answer) => (answer.status === "planned" ? `${answer.duration_s.toFixed(3)} s` : "–");

function clearance({ margins }) {
  const nearest = margins && margins.nearest;
  return nearest ? `${(1e3 * nearest.gap_m).toFixed(2)} mm, ${nearest.bodies.join(" and ")}` : "–";
}

const binds = ({ margins, sentence }) => (margins && margins.binds) || sentence || "–";

// The rows of the table: what it is, of the first answer, of the second, and whether both are the same.
function rows(first, second) {
  const ofAnswer = [["result", result], ["duration", duration], ["smallest clearance", clearance], ["what binds", binds]];
  return [
    ["text", ...changedLines(first.text, second.text).map(shown)],
    ...ofAnswer.map(([what, read]) => [what, read(first.answer), read(second.answer)]),
  ].map((row) => [...row, row[1] === row[2]]);
}

// Fills a table with what differs between two answers: { name, answer, text }.
export function fill(table, first, second) {
  const line = (kind, texts, same = false) => {
    const row = document.createElement("tr");
    row.classList.toggle("same", same);
    row.append(...texts.map((text, k) => {
      const cell = document.createElement(k === 0 ? "th" : kind);
      cell.textContent = text;
      return cell;
    }));
    return row;
  };
  table.replaceChildren(
    line("th", ["", `first: ${first.name}`, `second: ${second.name}`]),
    ...rows(first, second).map(([what, left, right, same]) => line("td", [what, left, right], same)),
  );
}
