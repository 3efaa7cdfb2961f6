// Legs, dwells, what is held and what may touch, as bars over time; and the census of a refusal as a bar chart.

// A bar of less than this share of the whole time has no room for its name; of more bars only the title has it.
const NARROW = 0.035;
const MANY = 20;

function element(name, className, text) {
  const made = document.createElement(name);
  made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

function bar(from, to, lasts, text, className, title) {
  const made = element("span", `bar ${className}`, text);
  made.style.left = `${(100 * from) / lasts}%`;
  made.style.width = `${Math.max(0.15, (100 * (to - from)) / lasts)}%`;
  made.title = title;
  // a name that does not fit stands beside its bar, on the side where there is room
  if (to - from < NARROW * lasts) made.classList.add(from > lasts / 2 ? "narrow-left" : "narrow");
  return made;
}

const seconds = (from, to) => `${from.toFixed(3)} to ${to.toFixed(3)} s`;

// Spans that overlap are put into lanes of their own.
function lanes(spans) {
  const found = [];
  for (const span of [...spans].sort((a, b) => a.from_s - b.from_s)) {
    const lane = found.find((each) => each[each.length - 1].to_s <= span.from_s + 1e-9);
    if (lane) lane.push(span);
    else found.push([span]);
  }
  return found;
}

export class Timeline {
  constructor(host, tracks, seek) {
    const { view } = tracks;
    this.lasts = view.lasts_s;
    this.host = host;
    const step = (number) => (view.control_points[number] ? view.control_points[number].name : "");
    const legs = view.legs.map((leg) => {
      const title = `${leg.kind} ${step(leg.step)}, ${seconds(leg.from_s, leg.to_s)} ${leg.note}`;
      const name = leg.kind === "WAIT" ? leg.note || leg.kind : leg.kind;
      return bar(leg.from_s, leg.to_s, this.lasts, name, `leg-${leg.kind.toLowerCase()}`, title);
    });
    if (legs.length) this.row("Legs", legs);
    const dwells = view.control_points.filter((point) => point.time_s !== null);
    const met = dwells.map((point) => {
      const title = `${point.kind} ${point.name}, ${seconds(point.time_s, point.until_s)}`;
      return bar(point.time_s, point.until_s, this.lasts, point.name, "dwell", title);
    });
    if (met.length) this.row("Points", met);
    if (view.held.length) {
      const held = view.held.map((span) =>
        bar(span.from_s, span.to_s, this.lasts, span.names[0], "held", `holds ${span.names[0]}, ${seconds(span.from_s, span.to_s)}`),
      );
      this.row("Gripper", held);
    }
    lanes(view.contacts).slice(0, 4).forEach((lane, k) => {
      const contact = lane.map((span) => {
        const both = span.names.join(" – ");
        return bar(span.from_s, span.to_s, this.lasts, both, "contact", `may touch: ${both}, ${seconds(span.from_s, span.to_s)}`);
      });
      this.row(k ? "" : "May touch", contact);
    });
    this.cursor = element("span", "cursor");
    this.scale = element("div", "scale");
    this.scale.append(this.cursor);
    this.scale.hidden = !host.children.length; // nothing to show over time: a refusal without a motion
    host.append(this.scale);
    const at = (event) => {
      const box = this.scale.getBoundingClientRect();
      seek(Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)) * this.lasts);
    };
    host.addEventListener("pointerdown", (event) => {
      if (event.clientX < this.scale.getBoundingClientRect().left - 4) return;
      host.setPointerCapture(event.pointerId);
      at(event);
    });
    host.addEventListener("pointermove", (event) => event.buttons && at(event));
  }

  row(name, bars) {
    const row = element("div", "lane");
    const track = element("div", "track");
    track.append(...bars);
    if (bars.length > MANY) track.querySelectorAll(".narrow, .narrow-left").forEach((each) => (each.textContent = ""));
    row.append(element("span", "name", name), track);
    this.host.append(row);
  }

  draw(t) {
    this.cursor.style.left = `${(100 * t) / this.lasts}%`;
  }
}

const MOST_LINES = 12;

// What refused how many candidates.
export function census(host, view) {
  const lines = view.census.slice(0, MOST_LINES);
  if (!lines.length) return;
  const most = Math.max(...lines.map((line) => line.count));
  host.append(element("h3", "", `What refused the candidates (${view.candidates} tried)`));
  const list = element("ol", "census");
  for (const line of lines) {
    const item = element("li", "");
    const track = element("div", "amount");
    const filled = element("span", "filled");
    filled.style.width = `${(100 * line.count) / most}%`;
    track.append(filled);
    item.append(element("span", "count", String(line.count)), track, element("span", "detail", line.detail));
    list.append(item);
  }
  host.append(list);
  const left = view.census.length - lines.length;
  if (left > 0) host.append(element("p", "faint", `and ${left} more kinds, in the answer below`));
}
