// SPDX-License-Identifier: Apache-2.0
// Pointers, wheel, keys, colours and print.
"use strict";
const cdeControls = (page) => {
  const { $, view, cursor, canvas, ruler, scroll, list, ROW } = page, root = document.documentElement;
  const timeAt = (x) => view.from + x / view.scale;
  const inside = (event, target) => event.clientX - target.getBoundingClientRect().left;

  // ---- wheel and pointers ----
  function wheel(event) {
    const unit = event.deltaMode === 1 ? 30 : event.deltaMode === 2 ? 400 : 1;
    if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) page.pan((event.deltaX || event.deltaY) * unit);
    else page.zoom(Math.exp(-event.deltaY * unit * 0.002), inside(event, canvas));
    event.preventDefault();
  }
  canvas.addEventListener("wheel", wheel, { passive: false });
  ruler.addEventListener("wheel", wheel, { passive: false });

  // A click near an edge selects the edge.
  function snapped(time, k) {
    const row = page.rows.shown[k];
    if (!row || !row.series) return page.within(time);
    const { times } = row.series, before = cdeValues.last(times, time), near = [times[before], times[before + 1]].filter((t) => Math.abs(t - time) * view.scale < 6);
    return page.within(near.length ? near.reduce((a, b) => Math.abs(a - time) < Math.abs(b - time) ? a : b) : time);
  }
  const fingers = new Map();
  function nearCursor(x) {
    return ["a", "b"].find((name) => cursor[name] !== null && Math.abs((cursor[name] - view.from) * view.scale - x) < 5);
  }
  function down(event) {
    if (event.button !== 0 && event.button !== 1) return;
    const onRuler = event.currentTarget === ruler, x = inside(event, canvas);
    fingers.set(event.pointerId, x);
    event.currentTarget.setPointerCapture(event.pointerId);
    const grabbed = event.pointerType === "mouse" && !event.shiftKey ? nearCursor(x) : null;
    const kind = fingers.size > 1 ? "pinch" : grabbed ? "cursor" : onRuler && event.offsetY < 9 ? "overview"
      : onRuler || event.altKey || event.ctrlKey || event.metaKey ? "range" : "pan";
    page.drag = { kind, name: grabbed, start: x, x, from: view.from, moved: false, shift: event.shiftKey };
    if (kind === "overview") overview(x);
    event.preventDefault();
    canvas.focus({ preventScroll: true });
  }
  const overview = (x) => { view.from = x / page.width * view.span - page.width / view.scale / 2; page.pan(0); };
  function move(event) {
    const drag = page.drag;
    if (!drag || !fingers.has(event.pointerId)) {
      canvas.classList.toggle("grab", Boolean(nearCursor(inside(event, canvas))));
      return;
    }
    const x = inside(event, canvas);
    if (drag.kind === "pinch") pinch(event.pointerId, x);
    fingers.set(event.pointerId, x);
    drag.x = x;
    if (Math.abs(x - drag.start) > 3) drag.moved = true;
    if (drag.kind === "overview") overview(x);
    else if (drag.kind === "cursor") { cursor[drag.name] = page.within(timeAt(x)); page.later(); }
    else if (drag.kind === "pan" && drag.moved) { view.from = drag.from - (x - drag.start) / view.scale; page.pan(0); }
    else if (drag.kind === "range") page.later();
  }
  function pinch(id, x) {
    const other = [...fingers].find(([finger]) => finger !== id);
    if (!other) return;
    const before = Math.abs(fingers.get(id) - other[1]), now = Math.abs(x - other[1]);
    if (before > 8 && now > 8) page.zoom(now / before, other[1]);
  }
  function up(event) {
    const drag = page.drag;
    fingers.delete(event.pointerId);
    if (!drag || fingers.size > 0) return;
    page.drag = null;
    const onRuler = event.currentTarget === ruler;
    if (drag.kind === "range" && drag.moved) page.zoomTo(timeAt(Math.min(drag.start, drag.x)), timeAt(Math.max(drag.start, drag.x)));
    else if (!drag.moved && (drag.kind === "pan" || drag.kind === "range")) click(event, drag, onRuler);
    else if (drag.kind === "cursor") page.say();
    page.later();
  }
  function click(event, drag, onRuler) {
    const k = onRuler ? page.chosen : Math.floor((event.offsetY + scroll.scrollTop) / ROW), row = page.rows.shown[k];
    const time = snapped(timeAt(drag.x), k), item = row && row.type === "transactions" ? row.item(timeAt(drag.x)) : null;
    if (!onRuler && row) page.choose(k, item);
    if (drag.shift) cursor.b = time;
    else cursor.a = time;
    if (item && !drag.shift) { cursor.a = Math.max(0, item.begin); cursor.b = item.end; }
    page.say();
  }
  for (const target of [canvas, ruler]) {
    target.addEventListener("pointerdown", down);
    target.addEventListener("pointermove", move);
    target.addEventListener("pointerup", up);
    target.addEventListener("pointercancel", (event) => { fingers.delete(event.pointerId); page.drag = null; page.later(); });
  }
  list.addEventListener("click", (event) => {
    const item = event.target.closest("[role=treeitem]");
    if (!item) return;
    const k = Math.floor(scroll.scrollTop / ROW) + [...list.children].indexOf(item), row = page.rows.shown[k];
    page.choose(k);
    if (row.type === "scope") page.fold(row);
  });
  scroll.addEventListener("scroll", page.later, { passive: true });

  // ---- keys ----
  const half = () => page.width / 2;
  const pin = () => { const row = page.rows.shown[page.chosen]; if (row) { page.rows.pin(row); page.rows.update(); page.arrange(); } };
  const cycleForm = () => {
    const names = [...$("form").options].map((o) => o.value).filter((name) => name !== "other…");
    if (!$("form").disabled) page.setForm(names[(names.indexOf($("form").value) + 1) % names.length]);
  };
  const between = () => { if (cursor.b !== null && cursor.b !== cursor.a) {
    const low = Math.min(cursor.a, cursor.b), high = Math.max(cursor.a, cursor.b), rim = (high - low) / 20;
    page.zoomTo(low - rim, high + rim);
  } };
  const keys = {
    "+": ["zoom in", () => page.zoom(1.5, atCursor())], "=": [null, () => page.zoom(1.5, atCursor())], "-": ["zoom out", () => page.zoom(1 / 1.5, atCursor())],
    "0": ["show the whole window", () => page.zoomTo(0, view.span)], z: ["show the time between the cursors", between],
    ArrowLeft: ["move left; with Shift a whole screen", (e) => page.pan(-page.width * (e.shiftKey ? 0.9 : 0.1))], ArrowRight: ["move right", (e) => page.pan(page.width * (e.shiftKey ? 0.9 : 0.1))],
    Home: ["cursor A to the begin", () => page.cursorA(0)], End: ["cursor A to the end", () => page.cursorA(page.span)],
    ArrowUp: ["select the signal above", () => page.choose(page.chosen - 1)], ArrowDown: ["select the signal below", () => page.choose(page.chosen + 1)],
    PageUp: ["a page of signals up", () => page.choose(page.chosen - Math.floor(scroll.clientHeight / ROW))], PageDown: ["a page of signals down", () => page.choose(page.chosen + Math.floor(scroll.clientHeight / ROW))],
    Enter: ["open or close a scope", () => page.fold(page.rows.shown[page.chosen])], " ": [null, () => page.fold(page.rows.shown[page.chosen])],
    n: ["cursor A to the next change of the selected signal", () => page.change(1)], p: ["cursor A to the previous change", () => page.change(-1)],
    b: ["cursor B to cursor A", () => { cursor.b = cursor.a; page.later(); }], x: ["exchange the cursors", () => { if (cursor.b !== null) { [cursor.a, cursor.b] = [cursor.b, cursor.a]; page.cursorA(cursor.a); } }],
    c: ["remove cursor B", () => { cursor.b = null; page.later(); }], v: ["next form of the values", cycleForm], l: ["show lanes in separate rows", page.toggleLanes],
    s: ["pin the selected signal to the top, or unpin it", pin], f: ["close or open all scopes", () => { const { rows } = page; rows.fold(rows.shown.some((r) => r.type === "scope" && r.open)); rows.update(); page.arrange(); }],
    "/": ["search signals", () => $("search").focus()], g: ["go to a time", () => $("goto").focus()], t: ["light or dark colours", () => theme(root.dataset.theme !== "dark", true)], "?": ["this list", () => $("keys").showModal()]
  };
  function atCursor() {
    const x = (cursor.a - view.from) * view.scale;
    return x >= 0 && x <= page.width ? x : half();
  }
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || $("keys").open) return;
    const { target } = event, typing = target.closest("input, select, textarea"), pressing = target.closest("button") && (event.key === " " || event.key === "Enter");
    if (typing && event.key === "Escape") { if (target === $("search")) { target.value = ""; searched(); } $("own-form").hidden = true; page.later(); canvas.focus(); return; }
    if (typing && target === $("search") && (event.key === "Enter" || event.key === "ArrowDown")) { list.focus(); event.preventDefault(); return; }
    if (typing || pressing || target === $("split") || target.closest("pre")) return;
    const row = page.rows.shown[page.chosen], inTree = target === list && row && row.type === "scope";
    if (inTree && (event.key === "ArrowLeft" || event.key === "ArrowRight")) page.fold(row, event.key === "ArrowRight");
    else if (Object.hasOwn(keys, event.key)) keys[event.key][1](event);
    else return;
    event.preventDefault();
  });
  const names = { ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓", PageUp: "Page Up", PageDown: "Page Down" };
  const rowsOfKeys = Object.entries(keys).filter(([, [what]]) => what).map(([key, [what]]) => `<div><dt><kbd>${names[key] || key}</kbd></dt><dd>${page.escape(what)}</dd></div>`);
  $("keys").innerHTML = `<h2>Keys</h2><dl>${rowsOfKeys.join("")}</dl><h2>Mouse</h2><dl>${[
    ["Click", "sets cursor A, at an edge if one is near"], ["Shift, click", "sets cursor B"], ["Drag", "moves the waves, or the cursor under the pointer"], ["Drag on the ruler", "zooms to the marked time; also Ctrl and drag on the waves"],
    ["Wheel", "zooms at the pointer; with Shift it moves; over names it scrolls"]].map(([key, what]) => `<div><dt>${key}</dt><dd>${what}</dd></div>`).join("")}</dl><form method="dialog"><button>Close</button></form>`;

  // ---- tools ----
  const on = (id, action) => $(id).addEventListener("click", action);
  on("zoom-in", () => page.zoom(1.5, atCursor()));
  on("zoom-out", () => page.zoom(1 / 1.5, atCursor()));
  on("zoom-all", () => page.zoomTo(0, view.span));
  on("zoom-cursors", between);
  on("previous", () => page.change(-1));
  on("next", () => page.change(1));
  on("lanes", page.toggleLanes);
  on("help", () => $("keys").showModal());
  on("theme", () => theme(root.dataset.theme !== "dark", true));
  $("form").addEventListener("change", () => page.setForm($("form").value));
  $("own-form").addEventListener("keydown", (event) => { if (event.key === "Enter" && event.target.value.trim()) page.setForm(event.target.value); });
  $("goto").addEventListener("keydown", (event) => { if (event.key === "Enter") page.jump($("goto").value); });
  function searched() {
    const { rows } = page, before = rows.shown[page.chosen];
    rows.query = $("search").value;
    rows.update();
    scroll.scrollTop = 0;
    page.arrange();
    const again = rows.shown.indexOf(before);
    page.choose(again >= 0 ? again : rows.shown.findIndex((row) => row.type !== "scope"));
    page.tell(rows.query.trim() ? `${rows.found} found` : "");
  }
  $("search").addEventListener("input", searched);

  // ---- width of the names ----
  const split = $("split");
  function widen(pixels) {
    const most = Math.max(160, $("stage").clientWidth - 160), wide = Math.round(Math.min(most, Math.max(120, pixels)));
    root.style.setProperty("--names", `${wide}px`);
    split.setAttribute("aria-valuenow", wide);
    page.resize();
  }
  const wideNow = () => list.clientWidth;
  split.addEventListener("pointerdown", (event) => { split.setPointerCapture(event.pointerId); event.preventDefault(); split.focus(); });
  split.addEventListener("pointermove", (event) => { if (split.hasPointerCapture(event.pointerId)) widen(event.clientX - $("stage").getBoundingClientRect().left); });
  split.addEventListener("keydown", (event) => { if (event.key === "ArrowLeft" || event.key === "ArrowRight") { widen(wideNow() + (event.key === "ArrowLeft" ? -16 : 16)); event.preventDefault(); } });

  // ---- colours and print ----
  const dark = matchMedia("(prefers-color-scheme: dark)");
  let kept = null;
  try { kept = localStorage.getItem("cde-waves-theme"); } catch { /* a page opened from a file may have no storage */ }
  function theme(isDark, keep = false) {
    root.dataset.theme = isDark ? "dark" : "light";
    $("theme").setAttribute("aria-pressed", isDark);
    if (keep) { try { localStorage.setItem("cde-waves-theme", kept = root.dataset.theme); } catch { kept = root.dataset.theme; } }
    page.useColours();
  }
  theme(kept ? kept === "dark" : dark.matches);
  dark.addEventListener("change", () => { if (!kept) theme(dark.matches); });
  addEventListener("beforeprint", () => { root.classList.add("paper"); page.useColours(true); page.print(); });
  addEventListener("afterprint", () => { root.classList.remove("paper"); page.useColours(false); page.afterPrint(); });
  split.setAttribute("aria-valuenow", wideNow());
};
