/* The table of the atlas: search, filters, sorting by columns. No libraries, no network. */
"use strict";

(() => {
  const SHOWN = 300; // rows drawn at first; a button draws the rest
  const source = document.getElementById("atlas-data");
  const root = document.getElementById("atlas");
  if (!source || !root) return;
  const data = JSON.parse(source.textContent);
  const column = Object.fromEntries(data.columns.map((name, i) => [name, i]));
  const state = { text: "", family: "", full: "", letter: "", range: "", by: -1, down: false, all: false };

  function make(tag, attributes = {}, ...children) {
    const node = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
    node.append(...children);
    return node;
  }

  function shown(cell) {
    if (cell === null) return "";
    if (cell === true) return "yes";
    if (cell === false) return "no";
    return String(cell);
  }

  const rows = data.rows.map((cells) => ({ cells, text: cells.map(shown).join("\u0000").toLowerCase() }));

  // -- what is chosen ---------------------------------------------------------------------------------------
  function chosen() {
    const words = state.text.toLowerCase().split(/\s+/).filter(Boolean);
    const wanted = [["family", state.family], ["full", state.full], ["letter", state.letter], ["range", state.range]];
    const active = wanted.filter(([, value]) => value !== "").map(([name, value]) => [column[name], value]);
    const found = rows.filter(
      (row) =>
        active.every(([i, value]) => shown(row.cells[i]) === value) && words.every((word) => row.text.includes(word)),
    );
    if (state.by >= 0) found.sort((a, b) => (state.down ? -1 : 1) * compared(a.cells[state.by], b.cells[state.by]));
    return found;
  }

  function compared(a, b) {
    if (a === b) return 0;
    const empty = (x) => x === null || x === "?";
    if (empty(a) || empty(b)) return (state.down ? -1 : 1) * (empty(a) ? (empty(b) ? 0 : 1) : -1); // last in both orders
    if (typeof a === "string") return a.localeCompare(b, "en", { numeric: true });
    return a - b;
  }

  // -- drawing ----------------------------------------------------------------------------------------------
  const message = make("p", { role: "status", class: "atlas-count" });
  const body = make("tbody");
  const more = make("button", { type: "button", class: "atlas-more" });
  const heads = data.columns.map((name, i) => {
    const button = make("button", { type: "button" }, name);
    button.addEventListener("click", () => {
      state.down = state.by === i && !state.down;
      state.by = i;
      draw();
    });
    return make("th", { scope: "col" }, button);
  });

  function draw() {
    const found = chosen();
    const drawn = state.all ? found : found.slice(0, SHOWN);
    body.replaceChildren(
      ...drawn.map((row) =>
        make("tr", {}, ...row.cells.map((cell, i) => make("td", typeof cell === "number" ? { class: "n" } : {}, shown(cell)))),
      ),
    );
    heads.forEach((head, i) => {
      if (i === state.by) head.setAttribute("aria-sort", state.down ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    });
    message.textContent = `${found.length} of ${rows.length} pairs`;
    more.hidden = drawn.length === found.length;
    more.textContent = `Show all ${found.length}`;
  }

  function choice(name, key, values) {
    const select = make("select", {}, make("option", { value: "" }, "all"));
    for (const value of values) select.append(make("option", { value }, value));
    select.addEventListener("change", () => {
      state[key] = select.value;
      draw();
    });
    return make("label", {}, `${name} `, select);
  }

  const search = make("input", { type: "search", placeholder: "su(3) CP" });
  search.addEventListener("input", () => {
    state.text = search.value;
    draw();
  });
  more.addEventListener("click", () => {
    state.all = true;
    draw();
  });
  const box = make("div", { class: "atlas-box", role: "region", tabindex: "0", "aria-label": "Table of the atlas" });
  box.append(make("table", {}, make("thead", {}, make("tr", {}, ...heads)), body));
  const controls = make("form", { class: "atlas-controls" }, make("label", {}, "Search ", search));
  controls.addEventListener("submit", (event) => event.preventDefault());
  controls.append(
    choice("Family", "family", Object.keys(data.counts)),
    choice("Full", "full", ["yes", "no"]),
    choice("Letter", "letter", ["A", "B", "C"]),
    choice("Range condition", "range", ["yes", "no"]),
  );
  root.replaceChildren(controls, message, box, more);
  draw();
})();
