// SPDX-License-Identifier: Apache-2.0
// The page of waves: the selection, the window, and drawing.
"use strict";
(() => {
  const { parseForm, timeText, parseLength, unpack, last } = cdeValues, draw = cdeDrawing;
  const $ = (id) => document.getElementById(id), root = document.documentElement;
  const data = JSON.parse($("data").textContent), origin = BigInt(data.from), span = Number(BigInt(data.to) - origin);
  const ROW = 26, FONT = "12px ui-monospace, \"DejaVu Sans Mono\", Menlo, Consolas, monospace";
  const canvas = $("waves"), ruler = $("ruler"), scroll = $("scroll"), list = $("list"), search = $("search"), formBox = $("form");
  let rows, colours, character = 7, width = 100, height = 100, chosen = 0, chosenItem = null, waiting = false, paper = false;
  const view = { from: 0, scale: 0, span: span + 1 };  // scale 0: the whole window
  const cursor = { a: data.cursor, b: null };
  let drag = null;  // the action of a pressed pointer

  const absolute = (time) => timeText(origin + BigInt(Math.round(time)), data.scale);
  function cycle(time) {
    if (!rows.edges) return null;
    const number = data.clock.first + last(rows.edges, time);
    return number < 0 ? null : number;
  }
  const within = (time) => Math.min(span, Math.max(0, Math.round(time)));
  const least = () => width / view.span, most = () => Math.max(least(), 200);  // pixels a unit
  const escape = (text) => text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);

  // ---- the window ----
  function settle() {
    view.scale = Math.min(most(), Math.max(least(), view.scale));
    view.from = Math.min(view.span - width / view.scale, Math.max(0, view.from));
    later();
  }
  function zoom(factor, x = width / 2) {
    const time = view.from + x / view.scale;
    view.scale = Math.min(most(), Math.max(least(), view.scale * factor));
    view.from = time - x / view.scale;
    settle();
  }
  function zoomTo(from, to) {
    view.scale = width / Math.max(to - from, 1e-6);
    view.from = from;
    settle();
  }
  function pan(pixels) {
    view.from += pixels / view.scale;
    settle();
  }
  function reveal(time) {
    const x = (time - view.from) * view.scale;
    if (x < 0 || x > width - 1) view.from = time - width / 2 / view.scale;
    settle();
  }
  function cursorA(time, tell = true) {
    cursor.a = within(time);
    reveal(cursor.a);
    if (tell) say();
  }

  // ---- drawing ----
  function later() {
    if (waiting || !rows) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; frame(); });
  }
  function sized(target, wide, tall) {
    const ratio = paper ? 3 : window.devicePixelRatio || 1;
    if (target.width !== Math.round(wide * ratio) || target.height !== Math.round(tall * ratio)) {
      target.width = Math.round(wide * ratio);
      target.height = Math.round(tall * ratio);
    }
    const pen = target.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, tall);
    pen.font = FONT;
    pen.textBaseline = "middle";
    return pen;
  }
  function frame() {
    const pen = sized(canvas, width, height), top = scroll.scrollTop, first = Math.floor(top / ROW);
    const edges = draw.gridTimes(view, width, rows.edges);
    character = pen.measureText("0").width;
    pen.fillStyle = colours.ground;
    pen.fillRect(0, 0, width, height);
    const x = (time) => (time - view.from) * view.scale;
    const number = Math.min(rows.shown.length, Math.ceil((top + height) / ROW));
    for (let k = first; k < number; ++k) {
      const y = k * ROW - top, row = rows.shown[k];
      if (k === chosen || row.type === "scope") {
        pen.fillStyle = k === chosen ? colours.chosen : colours.panel;
        pen.fillRect(0, y, width, ROW);
      }
    }
    pen.fillStyle = colours.rule;  // where nothing was dumped
    pen.globalAlpha = 0.6;
    for (const [begin, end] of data.dark) pen.fillRect(x(begin), 0, Math.max(1, x(end) - x(begin)), height);
    pen.globalAlpha = 1;
    pen.fillStyle = colours.grid;
    for (const time of edges) pen.fillRect(Math.round(x(time)), 0, 1, height);
    if (!edges.length) for (const time of ticks()) pen.fillRect(Math.round(x(time)), 0, 1, height);
    for (let k = first; k < number; ++k) {
      const y = k * ROW - top, row = rows.shown[k];
      if (row.type === "signal") {
        if (row.isBit) draw.bitRow(pen, row, view, width, y, ROW, colours);
        else draw.busRow(pen, row, view, width, y, ROW, colours, character);
      } else if (row.type === "transactions") {
        draw.transactionRow(pen, row, view, width, y, ROW, colours, character, chosenItem);
      }
    }
    const end = x(view.span);
    if (end < width) { pen.fillStyle = colours.panel; pen.fillRect(end, 0, width - end, height); }
    drawCursors(pen, x);
    drawRuler(x);
    fillList(first, number, top);
    fillReadout();
  }
  function drawCursors(pen, x) {
    for (const name of ["b", "a"]) {
      if (cursor[name] === null) continue;
      pen.fillStyle = colours[name];
      pen.fillRect(Math.round(x(cursor[name])) - 0.75, 0, 1.5, height);
    }
    if (drag && drag.kind === "range") {
      const left = Math.min(drag.start, drag.x), wide = Math.abs(drag.x - drag.start);
      pen.fillStyle = colours.b;
      pen.globalAlpha = 0.15;
      pen.fillRect(left, 0, wide, height);
      pen.globalAlpha = 1;
    }
  }
  // Times of the ruler's marks, from the begin of the window. They are round in the time of the file.
  function ticks() {
    const by = draw.step(view, 104), begin = Number(origin % BigInt(Math.round(by))), all = [];
    for (let time = Math.ceil((view.from + begin) / by) * by - begin; time <= view.from + width / view.scale && time <= span; time += by) if (time >= 0) all.push(time);
    return all;
  }
  function drawRuler(x) {
    const tall = 44, pen = sized(ruler, width, tall), shown = width / view.scale;
    pen.fillStyle = colours.panel;
    pen.fillRect(0, 0, width, tall);
    // Above: the visible part of the whole window.
    pen.fillStyle = colours.rule;
    pen.fillRect(0, 2, width, 5);
    pen.fillStyle = colours.soft;
    pen.fillRect(view.from / view.span * width, 2, Math.max(6, shown / view.span * width), 5);
    pen.fillStyle = colours.soft;
    for (const time of ticks()) {
      const at = Math.round(x(time)), text = absolute(time);
      pen.fillRect(at, 12, 1, 6);
      pen.fillText(text, Math.min(at + 4, width - character * text.length - 2), 18);
    }
    if (rows.edges) drawCycles(pen, x);
    for (const name of ["b", "a"]) {
      if (cursor[name] === null) continue;
      const at = Math.round(x(cursor[name]));
      pen.fillStyle = colours[name];
      const label = Math.max(7, Math.min(width - 7, at));
      if (at < -8 || at > width + 8) continue;
      pen.fillRect(label - 7, 9, 14, 14);
      pen.fillRect(at - 0.75, 9, 1.5, tall);
      pen.fillStyle = colours.ground;
      pen.fillText(name.toUpperCase(), label - character / 2, 16.5);
    }
  }
  function drawCycles(pen, x) {
    const { edges } = rows, first = draw.notBefore(edges, 0, view.from), seen = draw.notBefore(edges, first, view.from + width / view.scale) - first;
    const by = draw.step({ scale: width / Math.max(seen, 1) }, 66);
    for (let k = Math.ceil((data.clock.first + first) / by) * by - data.clock.first; k < first + seen; k += by) {
      const at = Math.round(x(edges[k])), text = `cyc:${data.clock.first + k}`;
      pen.fillRect(at, 28, 1, 5);
      if (at + character * text.length + 6 < width) pen.fillText(text, at + 4, 34);
    }
  }

  // ---- names and values ----
  function rowElement(k) {
    const made = document.createElement("div"), name = document.createElement("span"), value = document.createElement("span");
    made.id = `row${k}`;
    made.setAttribute("role", "treeitem");
    name.className = "name";
    value.className = "value";
    made.append(name, value);
    return made;
  }
  function fillList(first, number, top) {
    while (list.children.length < number - first) list.append(rowElement(list.children.length));
    [...list.children].forEach((item, k) => {
      const row = rows.shown[first + k];
      item.hidden = first + k >= number;
      if (item.hidden) return;
      const isScope = row.type === "scope", [name, value] = item.children, now = isScope ? "" : row.at(cursor.a);
      item.style.top = `${(first + k) * ROW - top}px`;
      item.className = `${row.type}${first + k === chosen ? " chosen" : ""}${row.isLane ? " lane" : ""}`;
      item.setAttribute("aria-level", row.level);
      item.setAttribute("aria-selected", first + k === chosen);
      item.setAttribute("aria-posinset", first + k + 1);
      item.setAttribute("aria-setsize", rows.shown.length);
      if (isScope) item.setAttribute("aria-expanded", row.open);
      else item.removeAttribute("aria-expanded");
      name.textContent = isScope ? `${row.open ? "▾" : "▸"} ${row.name}` : row.name + (row.pinned ? " ★" : "");
      name.title = row.note ? `${row.kind}: ${row.note}` : row.fullName;
      value.textContent = isScope ? (row.open ? "" : String(row.count)) : now.slice(0, 200);
      value.title = isScope ? "" : now.slice(0, 2000);
      value.dataset.name = row.fullName;
    });
    const shown = chosen >= first && chosen < number;
    if (shown) list.setAttribute("aria-activedescendant", `row${chosen - first}`);
    else list.removeAttribute("aria-activedescendant");
  }
  const moment = (time) => `${absolute(time)}${cycle(time) === null ? "" : `  cyc:${cycle(time)}`}`;
  function fillReadout() {
    const parts = [`<span class="a"><b>A</b> ${escape(moment(cursor.a))}</span>`];
    if (cursor.b !== null) {
      const by = Math.abs(cursor.b - cursor.a), cycles = cycle(cursor.a) === null || cycle(cursor.b) === null ? null : cycle(cursor.b) - cycle(cursor.a);
      const sign = cursor.b < cursor.a ? "−" : "";
      parts.push(`<span class="b"><b>B</b> ${escape(moment(cursor.b))}</span>`);
      parts.push(`<span id="difference"><b>B − A</b> ${sign}${timeText(BigInt(by), data.scale)}${cycles === null ? "" : `  ${String(cycles).replace("-", "−")} cycle${Math.abs(cycles) === 1 ? "" : "s"}`}${by ? `  ${frequency(by)}` : ""}</span>`);
    } else {
      parts.push('<span class="hint">Shift and click sets cursor B</span>');
    }
    const html = parts.join("");
    if ($("cursors").innerHTML !== html) $("cursors").innerHTML = html;
    fillDetails();
  }
  function frequency(units) {
    const hertz = 10 ** -data.scale / units, k = Math.min(4, Math.max(0, Math.floor(Math.log10(hertz) / 3)));
    return `${Number((hertz / 1000 ** k).toPrecision(4))} ${["Hz", "kHz", "MHz", "GHz", "THz"][k]}`;
  }
  let detailed = "";
  function fillDetails() {
    const row = rows.shown[chosen];
    let html = "";
    if (row && row.type === "signal") html = signalDetails(row);
    else if (row && row.type === "transactions") html = transactionDetails(chosenItem && row.items.includes(chosenItem) ? chosenItem : row.item(cursor.a));
    if (html !== detailed) $("details").innerHTML = detailed = html;
    const isSignal = row && row.type === "signal", wide = isSignal && !row.isText;
    formBox.disabled = !wide;
    if (wide) fillForms(row);
    $("lanes").disabled = !(wide && row.laneWidth);
    $("lanes").setAttribute("aria-pressed", Boolean(wide && row.lanes));
    $("previous").disabled = $("next").disabled = !isSignal && !(row && row.type === "transactions");
  }
  const pair = (key, value) => `<div><dt>${escape(key)}</dt><dd>${escape(value)}</dd></div>`;
  function signalDetails(row) {
    const one = (time) => row.at(time).slice(0, 400), items = [];
    items.push(pair("A", one(cursor.a)));
    if (cursor.b !== null) items.push(pair("B", one(cursor.b)));
    items.push(pair("changes", (row.series.times.length - 1).toLocaleString("en")));
    return `<h2>${escape(row.fullName)} <small>${escape(`${row.kind} ${row.range || (row.width > 1 ? `${row.width} bits` : "")}`)}</small></h2><dl>${items.join("")}</dl>${sourceDetails(row)}`;
  }
  function transactionDetails(t) {
    if (!t) return "";
    const items = [pair("from", t.begin < 0 ? "before this window" : moment(t.begin)), pair("to", moment(t.end)), pair("outcome", t.outcome)];
    if (t.stalls !== null) items.push(pair("stalls", `${t.stalls} cycles`));
    for (const [key, value] of t.fields) items.push(pair(key, value));
    return `<h2>${escape(t.kind)}: ${escape(t.label)} <small>${escape(t.scope)}</small></h2><dl>${items.join("")}</dl>`;
  }
  // Source lines that declare and drive the signal, with some context.
  function sourceDetails(row) {
    const places = rows.sources && rows.sources.of[row.number];
    if (!places || !places.length) return "";
    return `<div class="sources">${places.map(([file, line, what]) => {
      const { name, lines } = rows.sources.files[file], shown = [];
      for (let k = line - 2; k <= line + 2; ++k) {
        if (lines[k] === undefined) continue;
        shown.push(`<code${k === line ? ' class="here"' : ""}><i>${k}</i>${escape(lines[k])}\n</code>`);
      }
      return `<figure><figcaption>${escape(what)} <b>${escape(name)}:${line}</b></figcaption><pre tabindex="0">${shown.join("")}</pre></figure>`;
    }).join("")}</div>`;
  }
  const FORMS = ["hex", "dec", "signed", "bin", ...Object.keys(data.formats)];
  function fillForms(row) {
    const names = FORMS.filter((name) => cdeRows.fits(parseForm(name, data.formats), row.width));
    if (row.named) names.unshift("names");
    if (!names.includes(row.form.name)) names.push(row.form.name);
    const key = names.join();
    if (formBox.dataset.names !== key) {
      formBox.replaceChildren(...names.map((name) => new Option(name)), new Option("other…"));
      formBox.dataset.names = key;
    }
    if ($("own-form").hidden) formBox.value = row.form.name;
  }
  // "other…" asks for a form in a field of its own.
  function setForm(name) {
    const row = rows.shown[chosen], own = $("own-form");
    if (!row || row.type !== "signal" || row.isText) return;
    own.hidden = name !== "other…";
    if (!own.hidden) {
      own.value = "";
      own.focus();
      return;
    }
    const form = name === "names" ? row.named : parseForm(name, data.formats);
    if (form && cdeRows.fits(form, row.width)) {
      row.setForm(form);
      rows.update();
      arrange();
      tell(`${row.name} as ${form.name}: ${row.at(cursor.a)}`);
    } else {
      tell(`${name} is not a form for ${row.width} bits`);
      own.hidden = false;
    }
    own.setAttribute("aria-invalid", !own.hidden);
    formBox.dataset.names = "";
    later();
  }
  function tell(text) { $("told").textContent = text; }
  function say() {
    const row = rows.shown[chosen];
    tell(`A ${moment(cursor.a)}${row && row.type !== "scope" ? `, ${row.name} ${row.at(cursor.a).slice(0, 80)}` : ""}`);
  }

  // ---- the selection ----
  function arrange() {
    const tall = rows.shown.length * ROW;
    $("spacer").style.height = `${Math.max(0, tall - scroll.clientHeight)}px`;
    $("nothing").hidden = rows.shown.length > 0;
    chosen = Math.min(chosen, Math.max(0, rows.shown.length - 1));
    later();
  }
  function choose(k, item = null) {
    chosen = Math.max(0, Math.min(rows.shown.length - 1, k));
    chosenItem = item;
    $("own-form").hidden = true;
    const y = chosen * ROW;
    if (y < scroll.scrollTop) scroll.scrollTop = y;
    else if (y + ROW > scroll.scrollTop + scroll.clientHeight) scroll.scrollTop = y + ROW - scroll.clientHeight;
    later();
  }
  function fold(row, open) {
    if (!row || row.type !== "scope") return;
    row.group.open = open === undefined ? !row.group.open : open;
    rows.update();
    arrange();
  }
  function toggleLanes() {
    const row = rows.shown[chosen];
    if (!row || row.type !== "signal" || !row.laneWidth) return;
    row.showLanes(!row.lanes);
    rows.update();
    arrange();
  }
  function change(by) {
    const row = rows.shown[chosen];
    if (!row || !row.series) return;
    const { times } = row.series;
    const k = by > 0 ? last(times, cursor.a) + 1 : draw.notBefore(times, 0, cursor.a) - 1;
    if (k >= 0 && k < times.length) cursorA(times[k]);
    else tell("no further change in this window");
  }
  function jump(text) {
    const counted = /^(?:cyc:?|#)\s*(\d+)$/i.exec(text.trim());
    let time = NaN;
    if (counted) time = rows.edges ? rows.edges[Number(counted[1]) - data.clock.first] : NaN;
    else if (parseLength(text, data.scale) < 2 ** 63) time = Number(BigInt(Math.round(parseLength(text, data.scale))) - origin);
    if (!(time >= 0 && time <= span)) {
      $("goto").setAttribute("aria-invalid", "true");
      tell(`${text} is not a time in this window, ${absolute(0)} to ${absolute(span)}`);
      return;
    }
    $("goto").removeAttribute("aria-invalid");
    cursorA(time);
  }

  // The interface of the page for other files: pointers, keys, colours.
  const page = {
    $, data, view, cursor, span, canvas, ruler, scroll, list, ROW,
    get rows() { return rows; }, get width() { return width; }, get chosen() { return chosen; },
    get drag() { return drag; }, set drag(value) { drag = value; },
    zoom, zoomTo, pan, cursorA, reveal, later, choose, fold, toggleLanes, change, jump, setForm, arrange, tell, say, within, resize, useColours, print, afterPrint, escape
  };
  function afterPrint() {
    const times = width / view.scale, { from } = view;
    $("pane").style.height = "";
    width = canvas.clientWidth;
    zoomTo(from, from + times);
    resize();
  }
  function useColours(forPaper = paper) {
    paper = forPaper;
    colours = draw.colours(root);
    later();
  }
  function resize() {
    const wide = canvas.clientWidth, tall = scroll.clientHeight, whole = view.scale <= least() * 1.0001;
    if (!wide || !tall || paper) return;
    width = wide;
    height = tall;
    $("pane").style.height = `${tall}px`;
    if (whole) view.scale = least();
    arrange();
    settle();
  }
  // Prepares all rows for printing on a landscape sheet, as far as they fit, before the layout for paper. The times stay the same.
  function print() {
    const times = width / view.scale;
    height = Math.min(rows.shown.length, 120) * ROW;
    width = 700;
    view.scale = width / times;
    scroll.scrollTop = 0;
    $("pane").style.height = `${height}px`;
    $("spacer").style.height = "0";
    frame();
  }
  async function start() {
    rows = new cdeRows.Rows(data, await unpack(data));
    chosen = Math.max(0, rows.shown.findIndex((row) => row.type === "signal"));
    const clock = data.clock ? ` · clock ${data.clock.name}` : "";
    $("about").textContent = `${absolute(0)} to ${absolute(span)}${clock} · ${rows.total.toLocaleString("en")} signals · ${data.writer}${data.date ? `, ${data.date}` : ""}`;
    canvas.setAttribute("aria-label", `Waves of ${data.title}. Arrow keys move, plus and minus zoom, n and p go to changes of the selected signal.`);
    if (data.note) $("about").textContent += ` · ${data.note}`;
    useColours();
    cdeControls(page);
    resize();
    new ResizeObserver(resize).observe(scroll);
    root.dataset.ready = "yes";
  }
  start().catch((error) => {
    $("about").textContent = `These waves cannot be shown: ${error.message}. The page needs a browser from 2023 or later.`;
    root.dataset.ready = "no";
  });
})();
