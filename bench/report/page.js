// Draws the page from the data in it; comes behind plots.js.

const data = JSON.parse(document.getElementById("data").textContent);

// --- Panels -------------------------------------------------------------------------------------

function seriesTable(panel) {
  const rows = panel.series.map((series) => [series.name, ...series.facts]);
  return tableOf(["series", ...data.seriesColumns], rows);
}

function factList(panel) {
  const list = element("dl", { class: "facts" });
  for (const [name, value] of panel.facts) {
    list.append(element("div", {}, element("dt", {}, name), element("dd", {}, value)));
  }
  return list;
}

// What is drawn for a screen is scaled on paper, and its texts with it. So all is drawn anew, as wide
// as the columns of a page are.
const paper = { printing: false, wide: 690, narrow: 330 };
const redraws = new Map();  // by the body of a panel
for (const [event, printing] of [["beforeprint", true], ["afterprint", false]]) {
  window.addEventListener(event, () => {
    paper.printing = printing;
    for (const redraw of redraws.values()) redraw();
  });
}

// Draws one panel into `body`, and again where a series is switched or the width changes.
function fillPanel(body, panel) {
  const shown = new Set(panel.series.keys());
  const legend = element("div", { class: "legend", role: "group", "aria-label": "Series" });
  const plots = element("div", { class: "plots" });
  const figures = panel.plots.map((plot) => {
    const figure = element("figure", {}, element("figcaption", {}, plot.title));
    plots.append(figure);
    return figure;
  });
  const draw = () => {
    panel.plots.forEach((plot, i) => {
      const printed = i === 0 ? paper.wide : paper.narrow;
      const width = paper.printing ? printed : Math.max(280, Math.round(figures[i].clientWidth));
      const drawn = (plot.dots ? drawDots : drawLines)(plot, panel, shown, width);
      watchPointer(drawn, plot, panel);
      figures[i].querySelector("svg")?.remove();
      figures[i].append(drawn.svg);
    });
  };
  const buttons = panel.series.map((series, index) => {
    const button = element("button", { type: "button", "aria-pressed": "true" },
      swatch(series), series.name);
    button.addEventListener("click", () => set([index], !shown.has(index)));
    return button;
  });
  const set = (indices, on) => {
    for (const index of indices) {
      if (on) shown.add(index);
      else shown.delete(index);
      buttons[index].setAttribute("aria-pressed", on);
    }
    draw();
  };
  if (panel.family !== "micro") {
    legend.append(...buttons);
    for (const [name, on] of [["all", true], ["none", false]]) {
      const button = element("button", { type: "button", class: "all" }, name);
      button.addEventListener("click", () => set([...panel.series.keys()], on));
      legend.append(button);
    }
  }
  const parts = [legend, plots, factList(panel)];
  if (panel.family !== "micro") parts.push(seriesTable(panel));
  body.replaceChildren(...parts);
  draw();
  redraws.set(body, draw);
  let width = body.clientWidth;
  new ResizeObserver(() => {
    if (paper.printing || body.clientWidth === width) return;
    width = body.clientWidth;
    draw();
  }).observe(body);
}

// Panels of one title are variants: one is seen at a time.
function addPanels(section, panels, id) {
  const body = element("div");
  const head = element("div", { class: "head" }, element("h3", {}, panels[0].title));
  if (panels.length > 1) {
    const choice = element("select", { "aria-label": "Variant" });
    panels.forEach((panel, i) => choice.append(element("option", { value: i }, panel.variant)));
    choice.addEventListener("change", () => fillPanel(body, panels[choice.value]));
    head.append(choice);
  } else if (panels[0].variant !== "") {
    head.append(element("span", {}, panels[0].variant));
  }
  section.append(element("section", { class: "panel", id }, head, body));
  fillPanel(body, panels[0]);
}

// --- Tables -------------------------------------------------------------------------------------

function cellOf(value) {
  if (value === null) return element("td", { class: "absent" }, "not measured");
  if (typeof value !== "number") {
    return element("td", value.length > 34 ? { class: "long" } : {}, value);
  }
  const text = Math.abs(value) >= 1e5 || value === 0 || Math.abs(value) < 1e-3
    ? short(value) : String(Number(value.toPrecision(5)));
  return element("td", { class: "number", title: value }, text);
}

// Numbers by size, words by the alphabet, what is missing last in both directions.
function compare(a, b, direction) {
  if (a === null || b === null) return (a === null) - (b === null);
  const order = typeof a === "number" && typeof b === "number"
    ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
  return order * direction;
}

function tableOf(columns, rows) {
  const body = element("tbody");
  const nothing = columns.map((_, column) => rows.every((row) => row[column] === null));
  const fill = (sorted) => body.replaceChildren(...sorted.map((row) => {
    const bad = /^(hung|crashed|failed|broken)/.test(row.at(-1));
    const cells = row.map(cellOf);
    cells.forEach((cell, column) => cell.classList.toggle("nothing", nothing[column]));
    return element("tr", bad ? { class: "bad" } : {}, ...cells);
  }));
  const heads = columns.map((name, column) => {
    const numeric = rows.some((row) => typeof row[column] === "number");
    const button = element("button", { type: "button" }, name);
    const head = element("th", { scope: "col", class: numeric ? "number" : "" }, button);
    head.classList.toggle("nothing", nothing[column]);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      fill([...rows].sort((a, b) => compare(a[column], b[column], down ? -1 : 1)));
    });
    return head;
  });
  fill(rows);
  const table = element("table", {}, element("thead", {}, element("tr", {}, ...heads)), body);
  return element("div", { class: "scroll" }, table);
}

// --- The page -----------------------------------------------------------------------------------

function count(number, name) {
  return `${number} ${name}${number === 1 ? "" : "s"}`;
}

function fillHead() {
  const measured = data.runs - data.simulated;
  const parts = [];
  if (measured > 0) parts.push(`${measured} measured`);
  if (data.simulated > 0) parts.push(`${data.simulated} simulated (dashed, with open marks)`);
  document.getElementById("summary").textContent =
    `${count(data.runs, "run")} from ${count(data.files.length, "file")}: ${parts.join(", ")}. ` +
    "Bands and bars are intervals; what they mean stands beneath each figure. " +
    "A click on a name switches its line; a click on the head of a column sorts.";
  document.getElementById("notes").append(...data.notes.map((note) => element("li", {}, note)));
  document.getElementById("files").textContent = `Made by irt report of commit ${data.commit} from ` +
    data.files.map((file) => `${file.name} (${count(file.runs, "run")})`).join(", ");
}

function fillPage() {
  const main = document.getElementById("main");
  const contents = document.getElementById("contents");
  const titles = { frames: "In the ray tracer", operations: "Queues alone",
    micro: "Single operations" };
  main.replaceChildren();
  let id = 0;
  const addLink = (text) => {
    contents.append(element("a", { href: `#s${++id}` }, text));
    return `s${id}`;
  };
  for (const [family, title] of Object.entries(titles)) {
    const panels = data.panels.filter((panel) => panel.family === family);
    if (panels.length === 0) continue;
    const section = element("section", {}, element("h2", {}, title));
    main.append(section);
    for (const name of new Set(panels.map((panel) => panel.title))) {
      addPanels(section, panels.filter((panel) => panel.title === name), addLink(name));
    }
  }
  for (const table of data.tables) {
    const title = `Table: ${table.title.toLowerCase()}`;
    main.append(element("section", { class: "data", id: addLink(title) },
      element("h2", {}, table.title), tableOf(table.columns, table.rows)));
  }
}

fillHead();
fillPage();
