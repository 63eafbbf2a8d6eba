// SPDX-License-Identifier: Apache-2.0
// The packed data of the page: changes of signals, times as text, and values in every form, as `cde wave at` prints them.
"use strict";
const cdeValues = (() => {
  // Changes of one signal. Times count from the begin of the window. Entry 0 is the value there.
  class Track {
    constructor(meta, bytes, span) {
      Object.assign(this, { width: meta.w, count: meta.n, planes: meta.p || 1, texts: meta.texts || null, bytes, values: meta.v || 0 });
      this.plane = this.texts ? 4 : (this.width + 7) >> 3;
      this.stride = this.plane * (this.texts ? 1 : this.planes);
      this.pad = this.plane * 8 - this.width;
      this.at = meta.at;
      this.span = span;
      this.unpacked = null;
    }
    get times() {
      if (this.unpacked) return this.unpacked;
      const times = this.span < 2 ** 32 ? new Uint32Array(this.count) : new Float64Array(this.count), bytes = this.bytes;
      for (let i = 0, at = this.at, time = 0; i < this.count; ++i) {
        let byte = bytes[at++], step = byte & 127;
        for (let weight = 128; byte > 127; weight *= 128) {
          byte = bytes[at++];
          step += (byte & 127) * weight;
        }
        times[i] = time += step;
      }
      return this.unpacked = times;
    }
    // Bits as characters 0, 1, x, z.
    bits(entry, first, width) {
      const { bytes, plane, pad, planes } = this, at = this.values + entry * this.stride;
      let text = "";
      for (let k = pad + first; k < pad + first + width; ++k) {
        const shift = 7 - (k & 7), bit = bytes[at + (k >> 3)] >> shift & 1;
        const odd = planes === 2 && bytes[at + plane + (k >> 3)] >> shift & 1;
        text += odd ? (bit ? "x" : "z") : bit ? "1" : "0";
      }
      return text;
    }
    text(entry) {
      const { bytes } = this, at = this.values + entry * 4;
      return this.texts[bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | bytes[at + 3] << 24];
    }
    // Whether two entries have the same bits in this range.
    same(a, b, first, width) {
      const { bytes, plane, planes, stride, pad } = this;
      const low = pad + first, high = low + width - 1;
      for (let p = 0; p < planes; ++p) {
        const one = this.values + a * stride + p * plane, other = this.values + b * stride + p * plane;
        for (let k = low >> 3; k <= high >> 3; ++k) {
          let mask = 255;
          if (k === low >> 3) mask &= 255 >> (low & 7);
          if (k === high >> 3) mask &= 255 << (7 - (high & 7));
          if ((bytes[one + k] ^ bytes[other + k]) & mask) return false;
        }
      }
      return true;
    }
    unknown(entry, first, width) {
      if (this.planes < 2 || this.texts) return false;
      const { bytes, plane, pad } = this, at = this.values + entry * this.stride + plane;
      const low = pad + first, high = low + width - 1;
      for (let k = low >> 3; k <= high >> 3; ++k) {
        let mask = 255;
        if (k === low >> 3) mask &= 255 >> (low & 7);
        if (k === high >> 3) mask &= 255 << (7 - (high & 7));
        if (bytes[at + k] & mask) return true;
      }
      return false;
    }
  }

  // The last entry at or before a time, or -1.
  function last(times, time) {
    let low = 0, high = times.length;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (times[middle] <= time) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  // Forms: hex, dec, signed, bin, or a number format. With |mask the value may be a condition. /N after it sets the bits per lane.
  function parseForm(text, formats) {
    const [, name, mask, lane] = /^([a-z0-9]+)(\|mask)?(?:\/([1-9]\d{0,5}))?$/i.exec(text.trim()) || [];
    if (!name) return null;
    const form = { name: text.trim().toLowerCase(), kind: name.toLowerCase(), lane: lane ? Number(lane) : 0 };
    if (["hex", "dec", "signed", "bin"].includes(form.kind)) return mask ? null : form;
    let sizes = formats[form.kind];
    const free = /^e(\d+)m(\d+)$/.exec(form.kind);
    if (!sizes && free) sizes = [Number(free[1]), Number(free[2])];
    if (!sizes || sizes[0] < 3 || sizes[0] > 11 || sizes[1] < 2 || sizes[1] > 52) return null;
    const [exponent, fraction] = sizes;
    return { ...form, kind: "number", mask: !!mask, exponent, fraction, own: 1 + exponent + fraction, bias: 2 ** (exponent - 1) - 1 };
  }
  // Bits per lane of such a form, or 0.
  function laneBits(form, width) {
    if (form.lane) return form.lane;
    if (form.kind !== "number") return 0;
    const container = form.own <= 32 ? 32 : 64;
    return width % form.own === 0 || width % container !== 0 ? form.own : container;
  }
  function fits(form, width) {
    const lane = laneBits(form, width);
    return lane === 0 || width % lane === 0 && (form.kind !== "number" || lane >= form.own);
  }

  function hexadecimal(bits) {
    let text = "";
    for (let at = 0; at < bits.length;) {
      const size = at === 0 && bits.length % 4 || 4, digit = bits.slice(at, at + size);
      at += size;
      if (/^[01]+$/.test(digit)) text += parseInt(digit, 2).toString(16);
      else text += /^[01]*z[01z]*$/.test(digit) ? "z" : "x";
    }
    return text;
  }
  function decoded(bits, form) {
    const sign = bits[0] === "1" ? -1 : 1, e = parseInt(bits.slice(1, 1 + form.exponent), 2);
    const fraction = Number(BigInt("0b" + bits.slice(1 + form.exponent)));
    if (e === 2 ** form.exponent - 1) return fraction ? NaN : sign * Infinity;
    const unit = 2 ** (Math.max(e, 1) - form.bias - form.fraction);
    return sign * (e === 0 ? fraction : fraction + 2 ** form.fraction) * unit;
  }
  // The nearest number in a format, ties to even.
  function rounded(value, form) {
    const size = Math.abs(value);
    if (size === 0 || !isFinite(size)) return value;
    let e = Math.floor(Math.log2(size));
    if (2 ** e > size) --e;
    if (2 ** (e + 1) <= size) ++e;
    const unit = 2 ** (Math.max(e, 1 - form.bias) - form.fraction), steps = size / unit, whole = Math.floor(steps);
    const up = steps - whole > 0.5 || (steps - whole === 0.5 && whole % 2 === 1);
    const near = (whole + (up ? 1 : 0)) * unit;
    return Math.sign(value) * (near >= 2 ** (form.bias + 1) ? Infinity : near);
  }
  // The shortest text of a double, as C++ fmt prints it.
  function plain(value) {
    if (isNaN(value)) return "nan";
    const sign = value < 0 || Object.is(value, -0) ? "-" : "", size = Math.abs(value);
    if (size === Infinity) return sign + "inf";
    if (size === 0) return sign + "0";
    const [digits, power] = size.toExponential().split("e"), e = Number(power);
    if (e < -4 || e >= 16) return `${sign}${digits}e${e < 0 ? "-" : "+"}${String(Math.abs(e)).padStart(2, "0")}`;
    const bare = digits.replace(".", "");
    if (e < 0) return `${sign}0.${"0".repeat(-e - 1)}${bare}`;
    if (bare.length <= e + 1) return sign + bare + "0".repeat(e + 1 - bare.length);
    return `${sign}${bare.slice(0, e + 1)}.${bare.slice(e + 1)}`;
  }
  // Rounds to `digits` digits, ties to even, as printf in C.
  function nearest(value, digits) {
    const [up, exponent] = value.toExponential(digits - 1).split("e");
    const exact = Math.abs(value).toExponential(100).replace(".", "").split("e")[0];
    const last = Number(up.slice(-1));
    const tie = /^50*$/.test(exact.slice(digits));
    return Number(`${tie && last % 2 !== 0 ? up.slice(0, -1) + (last - 1) : up}e${exponent}`);
  }
  // The shortest decimal that reads back as this word.
  function number(bits, form) {
    if (!/^[01]+$/.test(bits)) return "x";
    const value = decoded(bits, form);
    if (isNaN(value)) return "nan";
    if (form.exponent === 11 && form.fraction === 52) return plain(value);
    for (let digits = 1; digits < 17 && isFinite(value); ++digits) {
      const near = nearest(value, digits);
      if (rounded(near, form) === value) return plain(Object.is(value, -0) ? -0 : near);
    }
    return plain(value);
  }
  function one(bits, form) {
    if (form.kind === "bin") return bits;
    if (form.kind === "names") return form.names[bits.replace(/^0+(?=.)/, "")] || hexadecimal(bits);
    if (form.mask && /^1+$/.test(bits)) return "true";
    if (form.kind === "number") return number(bits.slice(bits.length - form.own), form);
    if (form.kind === "hex") return hexadecimal(bits);
    if (!/^[01]+$/.test(bits)) return "x";
    const whole = BigInt("0b" + bits);
    return String(form.kind === "signed" ? BigInt.asIntN(bits.length, whole) : whole);
  }
  // Bits in a form. With many lanes, it stops after about `room` characters.
  function text(bits, form, room = Infinity) {
    const lane = laneBits(form, bits.length);
    if (lane === 0 || lane >= bits.length || bits.length % lane !== 0) return bits.length < lane ? "x" : one(bits, form);
    let made = "";
    for (let at = bits.length; at >= lane && made.length <= room; at -= lane) made += (made ? " " : "{") + one(bits.slice(at - lane, at), form);
    return made + "}";
  }

  // The text of a time, a BigInt in units of 10^scale seconds, with the largest unit that leaves a digit before the point.
  const UNITS = [["s", 0], ["ms", -3], ["us", -6], ["ns", -9], ["ps", -12], ["fs", -15]];
  function timeText(time, scale) {
    if (time < 0) return "-" + timeText(-time, scale);
    let digits = String(time);
    if (digits === "0") return "0";
    const [name, exponent] = UNITS.find((u) => u[1] <= scale + digits.length - 1) || UNITS[5], behind = exponent - scale;
    if (behind <= 0) return digits + "0".repeat(-behind) + name;
    digits = digits.padStart(behind + 1, "0");
    const fraction = digits.slice(-behind).replace(/0+$/, "");
    return digits.slice(0, -behind) + (fraction ? "." + fraction : "") + name;
  }
  // A number with or without a unit, in units of the file; NaN if the text is not a number.
  function parseLength(text, scale) {
    const found = /^(\d*\.?\d+(?:e[-+]?\d+)?)\s*(s|ms|us|µs|ns|ps|fs)?$/i.exec(text.trim());
    if (!found) return NaN;
    if (!found[2]) return Number(found[1]);
    const power = UNITS.find((u) => u[0] === found[2].toLowerCase().replace("µ", "u"))[1] - scale;
    return power >= 0 ? Number(found[1]) * 10 ** power : Number(found[1]) / 10 ** -power;
  }

  async function unpack(data) {
    const packed = Uint8Array.from(atob(data.packed), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    if (bytes.length !== data.size) throw new Error("the waves in this page are not whole");
    return bytes;
  }
  return { Track, last, parseForm, laneBits, fits, text, timeText, parseLength, unpack };
})();
