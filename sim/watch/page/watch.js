// Fetches samples as they come and shows them. With a token in the address it also says what the operator wants.
import { Chart, Columns, quantity } from "/chart.js";

const interval_ms = 100;
const most_samples = 600_000;  // of an axis

const element = (id) => document.getElementById(id);
const about = await (await fetch("/about")).json();
const mode = Object.fromEntries(about.modes.map((name, number) => [name, number]));
const token = new URLSearchParams(location.hash.slice(1)).get("token");

let from = 0;            // the number of the first sample that is not here yet
let came_at_ms = null;   // when the newest samples came; null: never
let axes = [];           // { name, columns, kicks }
let chosen = 0;
let following = true;
let view = null;         // the part that was enlarged, [from, to]
let marked = null;       // under the pointer: a time, or a pair while it is dragged
let frozen = [0, 1];     // what was shown when it was paused
let stale = true;        // something is to be drawn
let loading = false;     // there are samples already that are not here yet
let draw_again_ms = 0;   // not before that

// What FAULTS.md says of each fault: { name: [what was seen, what to do] }.
const explained = Object.fromEntries((await (await fetch("/FAULTS.md")).text()).split("\n")
  .filter((line) => line.startsWith("| "))
  .map((line) => line.slice(1, -1).split("|").map((part) => part.replace(/\[([^\]]*)\]\([^)]*\)|`/g, "$1").trim()))
  .map(([name, seen, todo]) => [name, [seen, todo]]));

// A kick begins where the mode becomes "kick".
const kickBegins = (column, place) => column.mode[place] === mode.kick && column.mode[place - 1] !== mode.kick;
const error = (column, place) => Math.abs(column.position_m[place] - column.target_m[place]);
const bandOf = (column, place) => {
  if (column.fault[place] > 0 || column.mode[place] === mode.fault) return "failed";
  return ["approach", "kick", "coast", "hold"].find((name) => mode[name] === column.mode[place]);
};

const charts = element("charts");
const always = [
  new Chart(charts, { title: "position", unit: "m", least: 1e-5, bands: bandOf, lines: [
    { of: (column, place) => column.target_m[place], color: "second", label: "target", steps: true },
    { of: (column, place) => column.position_m[place], color: "first", label: "position" }] }),
  new Chart(charts, { title: "distance to the target", unit: "m", scale: "log", bands: bandOf, lines: [
    { of: error, color: "first", label: "|position − target|" }] }),
  new Chart(charts, { title: "force", unit: "N", bands: bandOf, lines: [
    { of: (column, place) => column.command_N[place], color: "second", label: "commanded", steps: true },
    { of: (column, place) => column.reported_N[place], color: "first", label: "reported by the drive",
      steps: true }] }),
  new Chart(charts, { title: "modes, with a stroke where a kick begins", unit: "", lines: [], height: 34, bands: bandOf,
    marks: kickBegins, timeline: true }),
];
const whereKnown = [
  { field: "latency_us", chart: new Chart(charts, { title: "wake-up latency of the loop", unit: "µs", height: 90,
    lines: [{ of: (column, place) => column.latency_us[place], color: "first", label: "late by" }] }) },
  { field: "bus_load", chart: new Chart(charts, { title: "bus load", unit: "%", height: 90, timeline: true,
    lines: [{ of: (column, place) => 100 * column.bus_load[place], color: "first", label: "of the bit rate" }] }) },
];
for (const { chart } of whereKnown) chart.figure.hidden = true;

const legend = element("legend");
for (const name of ["approach", "kick", "coast", "hold", "failed"]) {
  const entry = document.createElement("span"), box = document.createElement("i");
  box.className = name;
  entry.append(box, name === "failed" ? "fault" : name);
  legend.append(entry);
}

function axisAt(place, names) {
  for (let next = axes.length; next <= place; ++next)
    axes.push({ name: names[next], columns: new Columns(about.fields.slice(1)), kicks: 0, known: new Set() });
  return axes[place];
}

function take(excerpt) {
  for (const row of excerpt.rows) {
    const axis = axisAt(row[0], excerpt.axes);
    const { columns } = axis;
    if (columns.length > 0 && row[1] < columns.last("time_s")) { columns.clear(); axis.kicks = 0; }  // another run
    columns.push(row, 1);
    if (columns.length > 1 && kickBegins(columns.column, columns.length - 1)) ++axis.kicks;
    for (const { field } of whereKnown) if (Number.isFinite(columns.last(field))) axis.known.add(field);
    columns.keep(most_samples);
  }
  from = excerpt.next;
  loading = excerpt.more;
  if (excerpt.rows.length > 0) {
    stale = true;
    came_at_ms = performance.now();
  }
  showLosses(excerpt);
}

function showLosses(excerpt) {
  const parts = [];
  if (excerpt.malformed > 0) parts.push(`${excerpt.malformed} could not be read; the newest: ${excerpt.complaint}`);
  if (excerpt.lost_on_the_way > 0) parts.push(`${excerpt.lost_on_the_way} samples were lost on the way here`);
  if (excerpt.lost_at_sender > 0) parts.push(`${excerpt.lost_at_sender} samples the node did not send`);
  element("losses").textContent = parts.join(" · ");
}

function faultOf(columns) {
  const number = columns.last("fault");
  if (!(number > 0)) return "";
  const code = columns.last("fault_code");
  const notes = [about.faults[number]];
  if (code > 0) notes.push(`error code ${code.toString(16).toUpperCase().padStart(4, "0")}h`);
  return notes.join(", ");
}

function troublesOf(columns) {
  const notes = [faultOf(columns)];
  if (columns.last("stop_not_obeyed") > 0) notes.push("stop not obeyed");
  if (columns.last("link_lost") > 0) notes.push("the interface is down");
  return notes.filter((note) => note !== "").join("; ");
}

// Rows and cells stay what they are, so that a click is not lost between two samples.
function rowOf(place) {
  const body = element("axes").tBodies[0];
  while (body.rows.length <= place) {
    const row = body.insertRow(), number = body.rows.length - 1;
    row.onclick = () => { chosen = number; stale = true; };
    for (let cell = 0; cell < 8; ++cell) row.insertCell();
    row.cells[7].className = "fault";
  }
  return body.rows[place];
}

function showTable() {
  axes.forEach(({ name, columns, kicks }, place) => {
    const row = rowOf(place);
    row.className = place === chosen ? "chosen" : "";
    [name || "axis",
      about.drives[columns.last("drive")] ?? "–",
      about.modes[columns.last("mode")] ?? "–",
      quantity(columns.last("position_m"), "m", 6),
      quantity(columns.last("position_m") - columns.last("target_m"), "m", 3),
      quantity(columns.last("reported_N"), "N", 3),
      columns.last("mode") >= 0 ? String(kicks) : "–",
      troublesOf(columns)].forEach((text, cell) => { row.cells[cell].textContent = text; });
  });
}

// Every fault that an axis has, with what it means.
function showFaults() {
  const place = element("fault");
  place.replaceChildren();
  for (const { name, columns } of axes) {
    const trouble = troublesOf(columns);
    if (trouble === "") continue;
    const line = document.createElement("p"), what = document.createElement("b");
    what.textContent = `${name ? `${name}: ` : ""}${trouble}`;
    const [seen, todo] = explained[about.faults[columns.last("fault")]] ?? ["", ""];
    line.append(what, seen ? ` — seen: ${seen}. Usual cause, and what to do: ${todo}.` : "");
    place.append(line);
  }
  place.hidden = place.childElementCount === 0;
}

// The part of time that is shown of an axis.
function shown(columns) {
  const first = columns.column.time_s[0], last = columns.last("time_s");
  if (view) return view;
  const width = Number(element("window").value);
  const begin = width > 0 ? Math.max(first, last - width) : first;
  return [begin, Math.max(last, begin + 1e-3)];
}

function showReading(axis) {
  if (marked === null || Array.isArray(marked)) return;
  const { column } = axis.columns;
  const place = Math.min(axis.columns.find(marked), axis.columns.length - 1);
  element("reading").textContent = [
    `at ${(column.time_s[place] - column.time_s[0]).toFixed(4)} s`,
    `position ${quantity(column.position_m[place], "m", 6)}`,
    `error ${quantity(column.position_m[place] - column.target_m[place], "m", 3)}`,
    `force ${quantity(column.reported_N[place], "N", 3)}`,
    about.modes[column.mode[place]] ?? ""].join("  ");
}

// A long run takes its time to draw: as much is left to the reader, and three times that while it is being loaded.
function drawInTurn() {
  requestAnimationFrame(drawInTurn);
  const begin = performance.now();
  if (!stale || axes.length === 0 || begin < draw_again_ms) return;
  stale = false;
  draw();
  const end = performance.now();
  draw_again_ms = end + (loading ? 3 : 1) * (end - begin);
}

function draw() {
  showTable();
  showFaults();
  element("controlled").textContent = chosenName();
  const axis = axes[Math.min(chosen, axes.length - 1)];
  if (axis.columns.length === 0) return;
  if (following) frozen = shown(axis.columns);
  const [begin, end] = view ?? frozen;
  const drawn = { from: begin, to: end, origin: axis.columns.column.time_s[0], marked };
  for (const chart of always) chart.draw(axis.columns, drawn);
  for (const { field, chart } of whereKnown) {
    chart.figure.hidden = !axis.known.has(field);
    if (!chart.figure.hidden) chart.draw(axis.columns, drawn);
  }
  showReading(axis);
  document.body.dataset.samples = axis.columns.length;
}

function follow(on) {
  following = on;
  if (on) view = null;
  element("follow").textContent = on ? "Pause" : about.live ? "Live" : "Whole run";
  stale = true;
}

function enlarge(a, b) {
  if (Math.abs(a - b) < 1e-4) return;
  view = [Math.min(a, b), Math.max(a, b)];
  following = false;
  element("follow").textContent = about.live ? "Live" : "Whole run";
}

function listen(chart) {
  const { canvas } = chart;
  let pressed = null;
  canvas.addEventListener("pointerdown", (event) => {
    pressed = chart.timeAt(event.clientX);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const time = chart.timeAt(event.clientX);
    marked = pressed === null ? time : [pressed, time];
    stale = true;
  });
  canvas.addEventListener("pointerup", (event) => {
    if (pressed !== null) enlarge(pressed, chart.timeAt(event.clientX));
    pressed = null;
    marked = null;
    stale = true;
  });
  canvas.addEventListener("pointerleave", () => { if (pressed === null) { marked = null; stale = true; } });
  canvas.addEventListener("dblclick", () => follow(true));
}

// The operator's part. Whatever moves an axis is asked for once more; a stop is not.
function confirmed(question) {
  element("question").textContent = question;
  const dialog = element("confirm");
  dialog.returnValue = "no";
  dialog.close();
  dialog.show();  // not modal: stop stays within reach
  // An event that comes late is that of the question before.
  return new Promise((resolve) => {
    dialog.onclose = () => { if (!dialog.open) resolve(dialog.returnValue === "yes"); };
  });
}

async function say(action, more = {}) {
  element("answer").textContent = "";
  try {
    const answer = await fetch("/command", {
      method: "POST",
      body: JSON.stringify({ axis: placeInNode(), action, ...more }),
      headers: { "Content-Type": "application/json", "X-Breakaway-Token": token },
    });
    const { refused } = await answer.json();
    // One that was done says nothing, and wipes nothing: what stands there by now may be of a later command.
    if (refused) element("answer").textContent = `not done: ${refused}`;
  } catch {
    element("answer").textContent = "not done: breakaway watch does not answer";
  }
}

// The axes come in the order in which they were first heard; a command names their place in the node.
const placeInNode = () => Math.max(0, about.axes.indexOf(axes[chosen]?.name));
const chosenName = () => about.axes[placeInNode()] || "the axis";

function prepareControl() {
  if (!about.control) return;
  if (!token) {
    element("notice").textContent =
      "This page may only look: to command, open the whole address that breakaway watch has printed.";
    element("notice").hidden = false;
    return;
  }
  element("control").hidden = false;
  element("stop").onclick = () => { element("confirm").close("no"); say("stop"); };
  element("enable").onclick = async () => {
    if (await confirmed(`Enable ${chosenName()}? It is energised and holds where it stands.`)) say("enable");
  };
  element("reset").onclick = async () => {
    if (await confirmed(`Reset the fault of ${chosenName()}? It stays disabled.`)) say("reset");
  };
  element("go").onclick = async () => {
    const text = element("target").value.trim().replace(",", ".");
    const target_m = Number(text);
    if (text === "" || !Number.isFinite(target_m)) {
      element("answer").textContent = "the target is no number of metres";
      return;
    }
    if (await confirmed(`Move ${chosenName()} to ${target_m} m?`)) say("target", { target_m });
  };
}

function connection() {
  if (!about.live) return ["", ""];
  if (came_at_ms === null) return ["silent", "waiting for samples"];
  const silent_s = Math.floor((performance.now() - came_at_ms) / 1000);
  return silent_s < 2 ? ["live", "live"] : ["silent", `no samples for ${silent_s} s`];
}

function showConnection(good) {
  const [kind, text] = good ? connection() : ["lost", "no answer: breakaway watch has ended or is out of reach"];
  element("connection").className = kind;
  element("connection").textContent = text;
}

async function poll() {
  let again = interval_ms;
  try {
    const headers = token ? { "X-Breakaway-Token": token } : {};
    const excerpt = await (await fetch(`/samples?from=${from}`, { headers })).json();
    take(excerpt);
    showConnection(true);
    if (excerpt.more) again = 0;
  } catch {
    showConnection(false);
    again = 1000;
  }
  setTimeout(poll, again);
}

element("source").textContent = about.description;
if (!about.live) element("window").value = "0";
element("window").onchange = () => follow(true);
element("follow").onclick = () => follow(!following);
window.onresize = () => { stale = true; };
prepareControl();
for (const chart of [...always, ...whereKnown.map(({ chart: one }) => one)]) listen(chart);
requestAnimationFrame(drawInTurn);
poll();
