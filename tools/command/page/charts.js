// SPDX-License-Identifier: Apache-2.0
// Saves every chart as a separate SVG, and its figures as CSV. Without scripts there are no buttons.
"use strict";
(() => {
  const SVG = "http://www.w3.org/2000/svg", WIDTH = 760, MARGIN = 24;
  // Style properties that become attributes, so that every SVG program can read them.
  const shape = { fill: "", stroke: "none", "stroke-width": "1px", "stroke-dasharray": "none", "stroke-linecap": "butt", opacity: "1" };
  const letters = { ...shape, "font-size": "", "font-weight": "400", "paint-order": "normal", "stroke-linejoin": "miter" };
  const looks = { rect: shape, circle: shape, line: shape, text: letters, tspan: letters };
  const meaning = new Set(["class", "role", "aria-label", "aria-hidden", "tabindex"]);

  // Names may have any character, but XML has no control characters.
  const clean = (text) => text.replace(/[^\t\n\r\x20-\ud7ff\ue000-\ufffd\u{10000}-\u{10ffff}]/gu, "\ufffd");
  function element(name, attributes, ...children) {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  }

  // A copy that needs no style sheet. Percentages become lengths for a plot `width` pixels wide.
  function plain(node, width) {
    if (node.nodeType === Node.TEXT_NODE) return document.createTextNode(clean(node.data));
    const copy = element(node.localName, {}), style = getComputedStyle(node);
    for (const { name, value } of node.attributes) {
      if (meaning.has(name) || name.startsWith("data-")) continue;
      copy.setAttribute(name, value.endsWith("%") ? Number((parseFloat(value) / 100 * width).toFixed(3)) : value);
    }
    for (const [name, usual] of Object.entries(looks[node.localName] || {})) {
      const value = style.getPropertyValue(name);
      if (value !== usual && !(name.startsWith("stroke") && style.stroke === "none")) copy.setAttribute(name, value);
    }
    copy.append(...[...node.childNodes].map((child) => plain(child, width)));
    return copy;
  }

  // Places the keys of the legend in lines.
  function keys(list, width, top) {
    const group = element("g", {}), ruler = document.createElement("canvas").getContext("2d");
    let x = 0, y = top;
    for (const item of list) {
      const text = clean(item.textContent), style = getComputedStyle(item);
      ruler.font = `13px ${style.fontFamily}`;
      const wide = 22 + ruler.measureText(text).width;
      if (x > 0 && x + wide > width) { x = 0; y += 22; }
      const swatch = element("g", { transform: `translate(${x.toFixed(1)} ${y})` });
      swatch.append(...[...item.querySelector("svg").children].map((child) => plain(child, 14)),
        element("text", { x: 21, y: 11, "font-size": "13px", fill: style.color }, text));
      group.append(swatch);
      x += wide + 22;
    }
    return { group, bottom: list.length ? y + 22 : top };
  }

  function picture(figure) {
    const root = document.documentElement, chart = figure.querySelector(".chart"), source = chart.querySelector("svg");
    root.classList.add("paper");  // uses the colours for print
    try {
      const left = parseFloat(getComputedStyle(chart).paddingLeft), width = WIDTH - 2 * MARGIN - left;
      const style = getComputedStyle(document.body), soft = getComputedStyle(figure.querySelector(".tick")).fill;
      const plot = element("g", { transform: `translate(${MARGIN + left} 66)` });
      plot.append(...[...source.children].map((child) => plain(child, width)));
      const below = 66 + parseFloat(source.getAttribute("height")) + 8;
      const { group, bottom } = keys([...figure.querySelectorAll(".legend li:not([hidden])")], WIDTH - 2 * MARGIN, below);
      group.setAttribute("transform", `translate(${MARGIN} 0)`);
      const height = bottom + 14, label = clean(source.getAttribute("aria-label")), title = clean(document.title);
      const svg = element("svg", { width: WIDTH, height, viewBox: `0 0 ${WIDTH} ${height}`, role: "img", "font-family": style.fontFamily },
        element("title", {}, label), element("rect", { width: WIDTH, height, fill: style.backgroundColor }),
        element("text", { x: MARGIN, y: 30, "font-size": "15px", "font-weight": "600", fill: style.color }, label),
        element("text", { x: MARGIN, y: 48, "font-size": "12px", fill: soft }, title), plot, group);
      return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(svg)}\n`;
    } finally {
      root.classList.remove("paper");
    }
  }

  function save(name, type, text) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  }
  const fileName = (text) => text.toLowerCase().replace(/[^\p{L}\p{N}]+/gu, "-").slice(0, 60).replace(/^-|-$/g, "");

  for (const figure of document.querySelectorAll("figure.plot")) {
    const label = figure.querySelector(".chart svg").getAttribute("aria-label");
    const name = `${fileName(document.title)}.${fileName(label)}`, bar = document.createElement("div");
    bar.className = "save";
    const button = (text, what, action) => {
      const made = document.createElement("button");
      made.type = "button";
      made.textContent = text;
      made.setAttribute("aria-label", `Save ${what} as ${text}: ${label}`);
      made.title = `Save ${what}`;
      made.addEventListener("click", action);
      bar.append(made);
    };
    button("SVG", "the chart", () => save(`${name}.svg`, "image/svg+xml;charset=utf-8", picture(figure)));
    button("CSV", "its figures", () => save(`${name}.csv`, "text/csv;charset=utf-8", figure.querySelector(".figures").textContent));
    figure.append(bar);
  }
})();
