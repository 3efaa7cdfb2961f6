// Undo and redo of a text, also over what replaces it as a whole. The undo of a browser does not reach over a text that a
// script sets, and a browser takes ten seconds to insert 1,600 lines as if they were typed.
const MOST_STEPS = 400;
const MOST_CHARACTERS = 2 ** 24;
const PAUSE_MS = 1000; // what is typed without such a pause is undone at once

export class History {
  constructor() {
    this.steps = [{ text: "", caret: 0, also: null }];
    this.now = 0;
    this.typed = null; // kind and time of the last change, if the next one of the same kind joins it
  }

  // The text has changed. `kind`: how it was typed (an inputType), null for a change that stands alone. `also`: another
  // text that was changed with it, { id, before, after }.
  add(text, caret, kind = null, also = null) {
    if (text === this.steps[this.now].text && also === null) return;
    const again = kind !== null && this.typed !== null && this.typed.kind === kind && Date.now() - this.typed.at < PAUSE_MS;
    const joins = again || (this.steps.length === 1 && this.steps[0].text === ""); // the empty page is no text
    this.typed = kind === null ? null : { kind, at: Date.now() };
    this.steps.length = this.now + (joins ? 0 : 1);
    this.steps.push({ text, caret, also });
    const length = ({ text: own, also: other }) => own.length + (other ? other.before.length + other.after.length : 0);
    const held = () => this.steps.reduce((sum, step) => sum + length(step), 0);
    while (this.steps.length > 2 && (this.steps.length > MOST_STEPS || held() > MOST_CHARACTERS)) this.steps.shift();
    this.now = this.steps.length - 1;
  }

  // The text before (-1) or after (+1) this one, with its caret, and the other text that changes with it, { id, from, to },
  // or null; null if there is none.
  step(by) {
    if (this.steps[this.now + by] === undefined) return null;
    this.typed = null;
    const { also } = this.steps[by < 0 ? this.now : this.now + 1];
    const [from, to] = also === null ? [] : by < 0 ? [also.after, also.before] : [also.before, also.after];
    this.now += by;
    return { ...this.steps[this.now], also: also && { id: also.id, from, to } };
  }
}
