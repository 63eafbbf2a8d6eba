// SPDX-License-Identifier: Apache-2.0
// Draws rows on a canvas. The time per frame depends on the pixels, and on the logarithm of the number of changes.
"use strict";
const cdeDrawing = (() => {
  const { last } = cdeValues;
  const NARROW = 2;  // pixels: changes closer than this are drawn as one block

  function colours(root) {
    const style = getComputedStyle(root), all = {};
    for (const name of ["ground", "ink", "soft", "rule", "grid", "panel", "chosen", "bit", "bus", "number", "unknown", "float", "a", "b",
      "t0", "t1", "t2", "t3", "bad"]) all[name] = style.getPropertyValue(`--${name}`).trim();
    return all;
  }

  // The first index from `from` on with a time at or after `time`.
  function notBefore(times, from, time) {
    let step = 1, high = from;
    while (high < times.length && times[high] < time) { from = high + 1; high += step; step *= 2; }
    high = Math.min(high, times.length);
    while (from < high) {
      const middle = (from + high) >>> 1;
      if (times[middle] < time) from = middle + 1;
      else high = middle;
    }
    return from;
  }

  // Calls steady(index, x, next, begins) for each value that is wide enough, and busy(x, next) for the others. `begins`: the value changed at x.
  function walk(times, view, width, steady, busy) {
    const X = (time) => (time - view.from) * view.scale;
    const stop = Math.min(width, X(view.span));
    let i = last(times, view.from), x = Math.max(0, X(0));
    if (i < 0) { i = 0; x = Math.max(0, X(times[0])); }
    let begins = x > 0 || times[i] === view.from;
    while (x < stop && i < times.length) {
      const next = i + 1 < times.length ? X(times[i + 1]) : Infinity;
      if (next - x >= NARROW || next >= stop) {
        steady(i, x, Math.min(next, stop), begins, next > stop);
        ++i;
        x = next;
      } else {
        const left = x;
        let right = x;
        do {
          right = Math.floor(right) + 1;
          i = notBefore(times, i + 1, view.from + right / view.scale) - 1;
          // Value `i` holds at `right`. The block goes on until a value is wide enough.
        } while (right < stop && i + 1 < times.length && X(times[i + 1]) - right < NARROW);
        busy(left, Math.min(right, stop));
        x = right;
      }
      begins = true;
    }
  }

  function bitRow(pen, row, view, width, top, height, c) {
    const { track, first } = row, high = top + 4.5, low = top + height - 4.5, path = new Path2D();
    const strange = [], blocks = [];
    let pen_x = -1;
    const place = track.pad + first, shift = 7 - (place & 7);
    walk(row.series.times, view, width, (index, x, next) => {
      const at = track.values + row.entry(index) * track.stride + (place >> 3);
      if (track.planes === 2 && track.bytes[at + track.plane] >> shift & 1) {
        strange.push([x, next - x, track.bytes[at] >> shift & 1]);
        pen_x = -1;
        return;
      }
      const y = track.bytes[at] >> shift & 1 ? high : low, left = Math.round(x) + (x > 0 ? 0.5 : 0);
      if (pen_x < 0) path.moveTo(left, y);
      else path.lineTo(left, y);
      path.lineTo(pen_x = Math.round(next) + 0.5, y);
    }, (x, next) => {
      blocks.push([x, next - x]);
      pen_x = -1;
    });
    pen.fillStyle = c.bit;
    pen.globalAlpha = 0.55;
    for (const [x, wide] of blocks) pen.fillRect(x, high, wide, low - high);
    pen.globalAlpha = 1;
    pen.strokeStyle = c.bit;
    pen.lineWidth = 1.5;
    pen.stroke(path);
    for (const [x, wide, isX] of strange) {
      pen.fillStyle = isX ? c.unknown : c.float;
      if (isX) {
        pen.globalAlpha = 0.25;
        pen.fillRect(x, high, wide, low - high);
        pen.globalAlpha = 1;
        pen.fillRect(x, high - 0.5, wide, 1);
        pen.fillRect(x, low - 0.5, wide, 1);
      } else {
        pen.fillRect(x, (high + low) / 2 - 0.5, wide, 1.5);
      }
    }
  }

  // Text within a width, cut with an ellipsis; empty if no character fits.
  function fitted(text, room, character) {
    const most = Math.floor(room / character);
    return text.length <= most ? text : most < 2 ? "" : text.slice(0, most - 1) + "…";
  }

  function busRow(pen, row, view, width, top, height, c, character) {
    const high = top + 3.5, low = top + height - 3.5, middle = (high + low) / 2;
    const colour = !row.isText && row.form.kind === "number" ? c.number : c.bus;
    const path = new Path2D(), odd = new Path2D(), fills = [], texts = [], blocks = [];
    walk(row.series.times, view, width, (index, x, next, begins, cut) => {
      const unknown = row.unknown(index), p = unknown ? odd : path;
      const slant = Math.min(3, (next - x) / 2), left = begins ? slant : 0, right = cut || next >= width ? 0 : slant;
      p.moveTo(x + left, high);
      p.lineTo(next - right, high);
      if (right) { p.lineTo(next, middle); p.lineTo(next - right, low); } else p.moveTo(next, low);
      p.lineTo(x + left, low);
      if (left) { p.lineTo(x, middle); p.lineTo(x + left, high); }
      if (unknown) fills.push([x, next - x]);
      const room = next - x - 8;
      if (room > character) {
        const text = fitted(row.text(index, Math.ceil(room / character) + 1), room, character);
        if (text) texts.push([text, x + 5, unknown || text.includes("nan")]);
      }
    }, (x, next) => blocks.push([x, next - x]));
    pen.lineWidth = 1;
    pen.fillStyle = colour;
    pen.globalAlpha = 0.45;
    for (const [x, wide] of blocks) pen.fillRect(x, high, wide, low - high);
    pen.fillStyle = c.unknown;
    pen.globalAlpha = 0.14;
    for (const [x, wide] of fills) pen.fillRect(x, high, wide, low - high);
    pen.globalAlpha = 1;
    pen.strokeStyle = colour;
    pen.stroke(path);
    pen.strokeStyle = c.unknown;
    pen.stroke(odd);
    for (const [text, x, strange] of texts) {
      pen.fillStyle = strange ? c.unknown : c.ink;
      pen.fillText(text, x, middle + 0.5);
    }
  }

  const TONES = { pci: "t0", bus: "t0", dma: "t1", pass: "t1", primary: "t2", secondary: "t2", test: "t3", record: "t3" };
  const BAD = /abort|error|bad|parity|timeout|refused/;
  function transactionRow(pen, row, view, width, top, height, c, character, chosen) {
    const X = (time) => (time - view.from) * view.scale, high = top + 3, tall = height - 6, { times } = row.series;
    let i = Math.max(0, last(times, view.from) - 1), covered = -1;
    while (i < times.length) {
      const t = row.items[i], x = Math.max(-8, X(t.begin)), end = Math.min(width + 8, Math.max(X(t.end), X(t.begin) + 1.5));
      if (x > width) break;
      if (end > covered) {
        pen.fillStyle = BAD.test(t.outcome) ? c.bad : c[TONES[row.kind] || "t0"];
        pen.globalAlpha = t === chosen ? 0.6 : 0.3;
        pen.fillRect(x, high, end - x, tall);
        pen.globalAlpha = 1;
        if (end - x > 3) {
          pen.fillRect(x, high, 1.5, tall);
          const from = Math.max(x, 0) + 6, text = fitted(t.label, end - from - 3, character);
          pen.fillStyle = c.ink;
          if (text) pen.fillText(text, from, high + tall / 2 + 0.5);
        }
        covered = end;
      }
      i = end - x <= 2 ? notBefore(times, i + 1, view.from + (Math.floor(end) + 0.5) / view.scale) : i + 1;
    }
  }

  // Steps of 1, 2 and 5 times powers of ten that leave room for `text`.
  function step(view, room) {
    const least = room / view.scale, power = 10 ** Math.floor(Math.log10(least));
    return Math.max(1, [1, 2, 5, 10].map((k) => k * power).find((s) => s >= least));
  }
  function gridTimes(view, width, edges) {
    if (edges) {
      const first = notBefore(edges, 0, view.from), end = notBefore(edges, first, view.from + width / view.scale);
      if (end > first && (end - first) * 10 < width) return Array.from(edges.slice(first, end));
    }
    return [];
  }
  return { colours, bitRow, busRow, transactionRow, step, gridTimes, notBefore };
})();
