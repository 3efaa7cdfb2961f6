// The faults of a text below it, each with a button that goes to its line.
import { goTo, number } from "./editor.js";
import { fileOf, partOf } from "./parts.js";

const find = (id) => document.getElementById(id);

export const fault = (error) =>
  `${error.field}${error.value === undefined ? "" : `: got ${JSON.stringify(error.value)}`}; allowed: ${error.allowed}`;

// Shows the faults of a text. Those of `other`, the text of its cell or its task (null: there is none), are behind a
// button that has `open` show that text.
export function showFaults(problem, other, open) {
  const errors = problem.errors || [];
  const elsewhere = ({ field }) => other !== null && /^cell(: |$)/.test(field) === (partOf(other.text) === "cell");
  const paragraphs = errors.map((error) => {
    const paragraph = document.createElement("p");
    if (error.line) {
      const go = document.createElement("button");
      go.textContent = elsewhere(error) ? `${fileOf(other)}, line ${error.line}` : `line ${error.line}`;
      go.addEventListener("click", () => {
        if (elsewhere(error)) open(other);
        goTo(error.line);
      });
      paragraph.append(go);
    }
    paragraph.append(fault(error));
    return paragraph;
  });
  if (!errors.length) {
    const paragraph = document.createElement("p");
    paragraph.textContent = problem.detail || problem.title;
    paragraphs.push(paragraph);
  }
  find("faults").replaceChildren(...paragraphs);
  number(new Set(errors.filter((error) => !elsewhere(error)).map((error) => error.line)));
}
