// SPDX-License-Identifier: Apache-2.0
// Shows one pair and one format of the profiles at a time. A click on a mark shows its figures. Without scripts all sections are visible.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const made = (name, properties, ...children) => {
    const element = Object.assign(document.createElement(name), properties);
    element.append(...children);
    return element;
  };

  for (const bar of document.querySelectorAll(".choose")) {
    const sections = [...document.querySelectorAll(`[data-choice="${bar.dataset.of}"]`)];
    if (sections.length < 2) continue;
    const select = made("select", { id: `choose-${bar.dataset.of}` });
    select.append(...sections.map((section) => made("option", { textContent: section.dataset.name })));
    const show = () => {
      for (const section of sections) section.hidden = section.dataset.name !== select.value;
    };
    const first = sections.find((section) => section.dataset.name === bar.dataset.first) || sections[0];
    select.value = first.dataset.name;
    select.addEventListener("change", show);
    bar.append(made("label", {}, `${bar.dataset.label} `, select));
    bar.hidden = false;
    show();
  }

  function choose(mark) {
    const entry = data.entries[Number(mark.dataset.of)], section = mark.closest("[data-choice]");
    const panel = section.querySelector(".chosen");
    for (const other of section.querySelectorAll(".mark.chosen-mark")) other.classList.remove("chosen-mark");
    for (const same of section.querySelectorAll(`.mark[data-of="${mark.dataset.of}"]`)) same.classList.add("chosen-mark");
    const rows = entry.figures.map(([name, value]) => made("tr", {}, made("th", { scope: "row", textContent: name }), made("td", { textContent: value })));
    const commands = entry.commands.flatMap(([what, text]) => [made("p", { textContent: what }), made("pre", { textContent: text })]);
    panel.replaceChildren(made("h4", { textContent: entry.name }), made("table", {}, made("tbody", {}, ...rows)), ...commands);
    mark.closest("figure").after(panel);
    panel.hidden = false;
  }
  for (const mark of document.querySelectorAll(".mark")) {
    mark.addEventListener("click", () => choose(mark));
    mark.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      choose(mark);
    });
  }
})();
