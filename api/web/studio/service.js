// Requests to the service, by addresses relative to the page, so that it works below any prefix. The key, if the service
// has keys, is kept for this tab.
import { session } from "./storage.js";

const find = (id) => document.getElementById(id);
const KEY = "assur-key";
let key = session.read(KEY);
let entered = null; // the promise of the form that is open: true once there is a key
let declined = false; // the form was closed without a key

export class Refused extends Error {
  constructor(problem) {
    super(problem.detail || problem.title || "The service did not answer.");
    this.problem = problem;
  }
}

// Opens the form for the key. True once a key was entered, false if the form was closed without one.
export function enterKey() {
  find("enter").hidden = false;
  find("key-message").textContent = key ? "The service does not know this key." : "The service needs a key.";
  entered = entered || new Promise((resolve) => {
    const dialog = find("key-dialog");
    find("key").value = "";
    dialog.returnValue = "";
    dialog.addEventListener("close", () => {
      entered = null;
      declined = dialog.returnValue !== "entered";
      resolve(!declined);
    }, { once: true });
    dialog.showModal();
  });
  return entered;
}

find("key-form").addEventListener("submit", (event) => {
  event.preventDefault();
  const value = find("key").value.trim();
  if (!/^[!-~]+$/.test(value)) { // nothing else can be sent in a header
    find("key-message").textContent = "A key has letters, digits and signs of ASCII, and no spaces.";
    return;
  }
  key = value;
  session.write(KEY, key);
  find("key-dialog").close("entered");
});
find("key-later").addEventListener("click", () => find("key-dialog").close());

// A response of the service. `quiet`: nobody pressed a button for it, so that a form that was closed stays closed.
// Raises `Refused`.
export async function ask(address, body, { method = body === undefined ? "GET" : "POST", quiet = false } = {}) {
  const headers = body === undefined ? {} : { "Content-Type": "application/json" };
  const sent = key;
  if (sent) headers.Authorization = `Bearer ${sent}`;
  let response;
  try {
    response = await fetch(address, { method, headers, body: typeof body === "object" ? JSON.stringify(body) : body });
  } catch {
    throw new Refused({ detail: "The service cannot be reached. Your text is kept here; try again later." });
  }
  if (response.ok) return response;
  if (response.status === 401) {
    const again = key !== sent || (!(quiet && declined) && (await enterKey()));
    if (again) return ask(address, body, { method, quiet });
    find("enter").hidden = false;
    throw new Refused({ detail: "The service needs a key. Press Key to enter one." });
  }
  let problem = { detail: `The service answered with status ${response.status}.` };
  try {
    problem = await response.json();
  } catch { /* a proxy answered, in its own words */ }
  throw new Refused(problem);
}
