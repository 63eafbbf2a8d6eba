// SPDX-License-Identifier: Apache-2.0
// The rows of the page: scopes, signals, their lanes and transactions, and which of them are shown.
"use strict";
const cdeRows = (() => {
  const { Track, parseForm, laneBits, fits, text } = cdeValues;

  // A signal, or some of its bits, in a form.
  class SignalRow {
    constructor(view, track, scope, formats) {
      this.type = "signal";
      this.name = view.name;
      this.scope = scope;
      this.kind = view.kind;
      this.range = view.range || "";
      this.track = track;
      this.whole = !view.bits;
      [this.first, this.width] = view.bits || [0, track.width];
      this.isText = !!track.texts;
      this.named = view.names ? { name: "names", kind: "names", lane: 0, names: view.names } : null;
      this.form = this.named || parseForm(view.form, formats) || { name: "hex", kind: "hex", lane: 0 };
      this.isBit = this.width === 1 && !this.isText;
      this.level = 2;
      this.lanes = null;  // rows of the lanes, while they are shown
      this.pinned = false;
      this.forget();
    }
    forget() {
      this.texts = new Map();
      this.own = null;
    }
    get fullName() { return this.scope ? `${this.scope}.${this.name}` : this.name; }
    // The times at which these bits change, with the entries of the track.
    get series() {
      if (this.own) return this.own;
      const { track } = this, { times } = track;
      if (this.whole) return this.own = { times, entries: null };
      const entries = [];
      for (let i = 0; i < times.length; ++i)
        if (i === 0 || !track.same(entries[entries.length - 1], i, this.first, this.width)) entries.push(i);
      return this.own = { times: times.constructor.from(entries, (i) => times[i]), entries };
    }
    entry(index) {
      const { entries } = this.series;
      return entries ? entries[index] : index;
    }
    bits(index) { return this.isText ? "" : this.track.bits(this.entry(index), this.first, this.width); }
    unknown(index) { return this.track.unknown(this.entry(index), this.first, this.width); }
    // The value after change `index`, cut after about `room` characters.
    text(index, room = Infinity) {
      if (index < 0) return "x";
      if (this.isText) return this.track.text(this.entry(index));
      const size = room <= 12 ? 12 : room <= 60 ? 60 : Infinity, key = size === Infinity ? index : `${index}/${size}`;
      let made = this.texts.get(key);
      if (made === undefined) {
        if (this.texts.size > 4000) this.texts.clear();
        this.texts.set(key, made = text(this.bits(index), this.form, size));
      }
      return made;
    }
    at(time) { return this.text(cdeValues.last(this.series.times, time)); }
    setForm(form) {
      this.form = form;
      this.forget();
      if (this.lanes) this.showLanes(true);
    }
    // Bits per lane, if there are several lanes.
    get laneWidth() {
      const lane = this.isText ? 0 : laneBits(this.form, this.width);
      return lane > 0 && lane < this.width && this.width % lane === 0 ? lane : 0;
    }
    showLanes(on) {
      this.lanes = null;
      const wide = this.laneWidth;
      if (!on || !wide) return;
      this.lanes = Array.from({ length: this.width / wide }, (_, k) => {
        const row = Object.create(SignalRow.prototype);
        Object.assign(row, this, { name: `${this.name}[${k}]`, first: this.first + this.width - wide * (k + 1), width: wide,
          whole: false, level: 3, lanes: null, isLane: true, isBit: wide === 1, range: "" });
        row.forget();
        return row;
      });
    }
  }

  // Transactions of a kind that do not overlap.
  class TransactionRow {
    constructor(kind, number) {
      this.type = "transactions";
      this.name = number ? `${kind} ${number + 1}` : kind;
      this.kind = kind;
      this.scope = "";
      this.level = 2;
      this.items = [];
      this.hidden = 0;  // transactions without a row
      this.end = -1;
    }
    get fullName() { return this.name; }
    get series() { return this.own || (this.own = { times: Float64Array.from(this.items, (t) => t.begin), entries: null }); }
    item(time) {
      const t = this.items[cdeValues.last(this.series.times, time)];
      return t && (time < t.end || time === t.begin) ? t : null;
    }
    at(time) { const t = this.item(time); return t ? t.label : ""; }
  }
  const MOST_TRACKS = 4;
  function transactionRows(list) {
    const kinds = new Map();
    for (const t of list) {
      if (!kinds.has(t.kind)) kinds.set(t.kind, []);
      const rows = kinds.get(t.kind);
      let row = rows.find((r) => r.end <= t.begin);
      if (!row && rows.length < MOST_TRACKS) rows.push(row = new TransactionRow(t.kind, rows.length));
      if (row) {
        row.items.push(t);
        row.end = Math.max(t.begin, t.end);
      } else {
        ++rows[0].hidden;
      }
    }
    for (const [first] of kinds.values()) {
      if (!first.hidden) continue;
      first.name += ` (+${first.hidden.toLocaleString("en")})`;
      first.note = `${first.hidden.toLocaleString("en")} overlapping transactions are not drawn`;
    }
    return [...kinds.values()].flat();
  }

  class Rows {
    constructor(data, bytes) {
      const span = Number(BigInt(data.to) - BigInt(data.from));
      const tracks = data.tracks.map((t) => new Track(t, bytes, span));
      this.edges = data.clock ? new Track(data.clock, bytes, span).times : null;
      this.groups = [];
      this.query = "";
      const json = (part) => JSON.parse(new TextDecoder().decode(bytes.subarray(part.at, part.at + part.n)));
      const transactions = data.transactions ? transactionRows(json(data.transactions)) : [];
      this.sources = data.sources ? json(data.sources) : null;
      this.pins = { name: "Pinned", rows: [], open: true };
      if (transactions.length) this.groups.push({ name: "Transactions", rows: transactions, open: true });
      let group = null, shown = 0;
      data.views.forEach((view, number) => {
        const scope = data.scopes[view.scope];
        if (!group || group.scope !== scope) {
          group = { name: scope || "(no scope)", scope, rows: [], open: data.chosen || shown < 60 };
          this.groups.push(group);
        }
        const row = new SignalRow(view, tracks[view.track], scope, data.formats);
        row.number = number;
        if (group.open) ++shown;
        group.rows.push(row);
      });
      this.total = data.views.length;
      this.update();
    }
    // Matches a part of a name, ignoring case, or a pattern of the whole name.
    matcher() {
      const query = this.query.trim().toLowerCase();
      if (!query) return () => true;
      if (!/[*?]/.test(query)) return (row) => row.fullName.toLowerCase().includes(query);
      const pattern = query.replace(/[.+^${}()|[\]\\]/g, "\\$&").replace(/\*/g, ".*").replace(/\?/g, ".");
      const whole = new RegExp(`^(.*\\.)?${pattern}$`);
      return (row) => whole.test(row.fullName.toLowerCase());
    }
    // The shown rows, from top to bottom.
    update() {
      const matches = this.matcher(), searching = this.query.trim() !== "";
      this.shown = [];
      this.found = 0;
      for (const group of [this.pins, ...this.groups]) {
        const rows = group.rows.filter((row) => (group === this.pins || !row.pinned) && matches(row));
        if (rows.length === 0) continue;
        this.found += rows.length;
        const open = group.open || searching;
        this.shown.push({ type: "scope", name: group.name, fullName: group.name, group, open, count: rows.length, level: 1 });
        if (!open) continue;
        for (const row of rows) {
          this.shown.push(row);
          if (row.lanes) for (const lane of row.lanes) this.shown.push(lane);
        }
      }
    }
    pin(row) {
      if (row.type === "scope" || row.isLane) return;
      row.pinned = !row.pinned;
      if (row.pinned) this.pins.rows.push(row);
      else this.pins.rows = this.pins.rows.filter((r) => r !== row);
    }
    fold(all) { for (const group of [this.pins, ...this.groups]) group.open = !all; }
  }
  return { Rows, fits };
})();
