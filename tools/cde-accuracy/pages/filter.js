// SPDX-License-Identifier: Apache-2.0
// Filters charts and tables by format, and zooms charts. Without scripts everything is visible.
"use strict";
(() => {
  const SVG = "http://www.w3.org/2000/svg", CLOSEST = 1 / 64;
  const entries = JSON.parse(document.getElementById("data").textContent).entries;
  const formats = [...new Set(entries.map((entry) => entry.format))], off = new Set();
  const shown = (part) => !off.has(entries[Number(part.dataset.of)].format);
  const made = (name, attributes, text = "") => {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.textContent = text;
    return element;
  };
  const number = (element, name) => parseFloat(element.getAttribute(name));
  const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

  // ---- Axes of a zoomed chart ----
  function ticks(low, high) {
    const decades = Math.log10(high / low), found = [];
    const factors = decades > 2 ? [1] : decades > 0.7 ? [1, 2, 5] : [...Array(90).keys()].map((k) => 1 + k / 10);
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); ++power)
      found.push(...factors.map((factor) => Number((factor * 10 ** power).toPrecision(3))).filter((value) => value >= low && value <= high));
    return found;
  }
  function text(value, seconds) {
    if (seconds) {
      const unit = clamp(Math.floor((Math.floor(Math.log10(value) + 1e-9) + 9) / 3), 0, 3);
      return `${Number((value * 10 ** (9 - 3 * unit)).toPrecision(3))} ${["ns", "µs", "ms", "s"][unit]}`;
    }
    return value >= 0.99 && value < 9999 ? String(value) : value.toExponential().replace("+", "");
  }

  // ---- Dots by two figures, and the line of the best visible dots ----
  class Scatter {
    constructor(group) {
      this.group = group;
      [this.xs, this.ys] = [group.dataset.x, group.dataset.y].map((range) => range.split(" ").map(Number));
      [this.top, this.tall] = [Number(group.dataset.top), Number(group.dataset.tall)];
      const share = (y) => 1 - (y - this.top) / this.tall;
      this.marks = [...group.querySelectorAll(".mark")].map((part) => {
        const circle = part.querySelector("circle:last-of-type");
        return { part, hollow: circle.classList.contains("hollow"), x: number(circle, "cx") / 100, y: share(number(circle, "cy")) };
      });
      this.whiskers = [...group.querySelectorAll(".whisker")].map((part) =>
        ({ part, x: number(part, "x1") / 100, low: share(number(part, "y1")), high: share(number(part, "y2")) }));
      this.frame = [...group.children].filter((part) => !part.matches(".mark, .whisker, .pareto"));
      this.whole();
      this.addControls();
    }
    whole() { this.view = { x: [0, 1], y: [0, 1] }; }
    get closer() { return this.view.x[1] - this.view.x[0] < 0.999; }
    atX(share) { return 100 * (share - this.view.x[0]) / (this.view.x[1] - this.view.x[0]); }
    atY(share) { return this.top + this.tall * (1 - (share - this.view.y[0]) / (this.view.y[1] - this.view.y[0])); }
    inside(x, y) {
      const { view } = this, within = (value, [low, high]) => value >= low - 1e-6 && value <= high + 1e-6;
      return within(x, view.x) && within(y, view.y);
    }
    line(looks, x1, y1, x2, y2) {
      const [left, right] = [x1, x2].map((x) => clamp(this.atX(x), 0, 100)), [from, to] = [y1, y2].map((y) => clamp(this.atY(y), this.top, this.top + this.tall));
      return made("line", { class: looks, x1: `${left}%`, x2: `${right}%`, y1: from, y2: to });
    }
    best() {
      const lines = [], { view } = this;
      for (const hollow of [false, true]) {
        const best = [], looks = hollow ? "pareto dashed" : "pareto";
        const marks = this.marks.filter((mark) => mark.hollow === hollow && shown(mark.part)).sort((a, b) => a.x - b.x || a.y - b.y);
        for (const mark of marks) if (!best.length || mark.y < best.at(-1).y) best.push(mark);
        best.forEach((mark, i) => {
          const next = best[i + 1], right = next ? next.x : 1;
          if (mark.y >= view.y[0] && mark.y <= view.y[1]) lines.push(this.line(looks, mark.x, mark.y, right, mark.y));
          if (next && right >= view.x[0] && right <= view.x[1]) lines.push(this.line(looks, right, mark.y, right, next.y));
        });
      }
      return lines;
    }
    axes() {
      if (!this.closer) return this.frame;
      const bottom = this.top + this.tall, parts = [this.frame.at(-1)];  // the title of the axis
      for (const [range, view, across] of [[this.xs, this.view.x, true], [this.ys, this.view.y, false]]) {
        const at = (share) => range[0] * (range[1] / range[0]) ** share, values = ticks(at(view[0]), at(view[1]));
        const most = across ? Math.max(3, this.group.ownerSVGElement.clientWidth / 70) : 7, step = Math.ceil(values.length / most);
        values.filter((_, i) => i % step === 0).forEach((value) => {
          const share = Math.log(value / range[0]) / Math.log(range[1] / range[0]);
          const x = `${this.atX(share)}%`, y = this.atY(share), label = text(value, across && "seconds" in this.group.dataset);
          parts.push(across ? made("line", { class: "grid", x1: x, x2: x, y1: this.top, y2: bottom }) : made("line", { class: "grid", x1: 0, x2: "100%", y1: y, y2: y }),
            across ? made("text", { class: "tick", x, y: bottom + 16, "text-anchor": "middle" }, label)
              : made("text", { class: "tick", x: -8, y: y + 4, "text-anchor": "end" }, label));
        });
      }
      return parts;
    }
    draw() {
      const marks = this.marks.filter((mark) => shown(mark.part) && this.inside(mark.x, mark.y));
      for (const { part, x, y } of marks) {
        const px = `${this.atX(x)}%`, py = this.atY(y);
        for (const circle of part.querySelectorAll("circle")) { circle.setAttribute("cx", px); circle.setAttribute("cy", py); }
        const letter = part.querySelector("text");
        if (letter) { letter.setAttribute("x", px); letter.setAttribute("y", py + 3.5); }
      }
      const whiskers = this.whiskers.filter(({ part, x }) => shown(part) && x >= this.view.x[0] && x <= this.view.x[1]);
      for (const { part, x, low, high } of whiskers) {
        const line = this.line("", x, low, x, high);
        for (const name of ["x1", "x2", "y1", "y2"]) part.setAttribute(name, line.getAttribute(name));
      }
      this.group.replaceChildren(...this.axes(), ...this.best(), ...whiskers.map(({ part }) => part), ...marks.map(({ part }) => part));
      this.group.closest(".chart").classList.toggle("closer", this.closer);
    }
    look(factor, centre) {
      for (const axis of ["x", "y"]) {
        const [low, high] = this.view[axis], wide = clamp((high - low) * factor, CLOSEST, 1);
        const middle = clamp(centre[axis], wide / 2, 1 - wide / 2);
        this.view[axis] = [middle - wide / 2, middle + wide / 2];
      }
      this.draw();
    }
    // The selected mark, or the middle of the view.
    centre() {
      const chosen = this.marks.find(({ part, x, y }) => part.classList.contains("chosen-mark") && shown(part) && this.inside(x, y));
      return chosen || { x: (this.view.x[0] + this.view.x[1]) / 2, y: (this.view.y[0] + this.view.y[1]) / 2 };
    }
    addControls() {
      const svg = this.group.ownerSVGElement, bar = Object.assign(document.createElement("div"), { className: "zoom" });
      const actions = { "+": ["Zoom in", () => this.look(0.5, this.centre())], "−": ["Zoom out", () => this.look(2, this.centre())], All: ["Show the whole chart", () => this.look(64, this.centre())] };
      for (const [label, [title, action]] of Object.entries(actions)) {
        const button = Object.assign(document.createElement("button"), { type: "button", textContent: label, title });
        button.setAttribute("aria-label", `${title}: ${svg.getAttribute("aria-label")}`);
        button.addEventListener("click", action);
        bar.append(button);
      }
      this.group.closest("figure").append(bar);
      let from = null;
      svg.addEventListener("pointerdown", (event) => { if (this.closer && !event.target.closest(".mark")) { from = event; svg.setPointerCapture(event.pointerId); } });
      svg.addEventListener("pointerup", () => { from = null; });
      svg.addEventListener("pointermove", (event) => {
        if (!from) return;
        const { x, y } = this.view, wide = x[1] - x[0], high = y[1] - y[0];
        const centre = { x: (x[0] + x[1]) / 2 - (event.clientX - from.clientX) / svg.clientWidth * wide, y: (y[0] + y[1]) / 2 + (event.clientY - from.clientY) / this.tall * high };
        from = event;
        this.look(1, centre);
      });
    }
  }
  const scatters = [...document.querySelectorAll(".scatter")].map((group) => new Scatter(group));

  // ---- Rows of marks, tables, legends ----
  const charts = [...document.querySelectorAll("figure.plot")].filter((figure) => figure.querySelector(".row")).map((figure) =>
    ({ figure, svg: figure.querySelector(".chart svg"), rows: [...figure.querySelectorAll(".row")].map((row) => ({ row, parts: [...row.children] })) }));
  for (const chart of charts) chart.top = parseFloat(chart.rows[0].row.getAttribute("transform").split(" ")[1]);
  function stack({ figure, svg, rows, top }) {
    let bottom = top;
    const kept = rows.filter(({ parts }) => parts.some((part) => part.dataset.of && shown(part)));
    for (const { row } of rows) row.remove();
    for (const { row, parts } of kept) {
      row.replaceChildren(...parts.filter((part) => !part.dataset.of || shown(part)));
      row.setAttribute("transform", `translate(0 ${bottom})`);
      svg.append(row);
      bottom += Number(row.dataset.tall);
    }
    svg.setAttribute("height", bottom);
    for (const line of svg.querySelectorAll(":scope > .grid")) line.setAttribute("y2", bottom);
    const folded = figure.closest("details"), summary = folded?.querySelector("summary");
    (folded || figure).hidden = kept.length === 0;
    if (summary) summary.textContent = summary.textContent.replace(/^\d+ configurations?/, `${kept.length} configuration${kept.length === 1 ? "" : "s"}`);
  }
  function draw() {
    for (const scatter of scatters) scatter.draw();
    for (const chart of charts) stack(chart);
    for (const row of document.querySelectorAll('[data-choice="pair"] tbody tr')) {
      const words = (row.querySelector("th")?.textContent || "").split(" ");
      row.hidden = [...off].some((format) => words.includes(format));
    }
    for (const key of document.querySelectorAll('[data-choice="pair"] .legend li')) key.hidden = off.has(key.textContent);
  }
  const bar = document.querySelector(".formats");
  for (const format of formats.length > 1 ? formats : []) {
    const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: true, value: format }), label = document.createElement("label");
    box.addEventListener("change", () => { off[box.checked ? "delete" : "add"](format); draw(); });
    label.append(box, format);
    bar.append(label);
    bar.hidden = false;
  }
})();
