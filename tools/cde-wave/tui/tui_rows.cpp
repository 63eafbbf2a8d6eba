// SPDX-License-Identifier: Apache-2.0
#include "tui/tui_rows.hpp"

#include <algorithm>

#include "cde/support/message.hpp"

namespace cde::wave::tui {
namespace {

__extension__ using Wide = unsigned __int128;

/// Beyond this many changes in a column, it is not checked whether they affect the bits of the
/// view.
constexpr std::size_t kLookedAt = 64;

/// Walks through the values of a view in the blocks of a file, from a time on.
class Walk {
 public:
  Walk(Wave& wave, std::uint64_t from, std::uint64_t to) : view_(wave.view()) {
    Tracks& tracks = wave.tracks();
    for (std::size_t k = tracks.block_of(from); k <= tracks.block_of(to); ++k)
      all_.push_back(tracks.get(view_.signal.handle, k));
    change_ = all_.front()->at(from);
    read();
  }
  [[nodiscard]] const std::string& bits() const { return bits_; }
  [[nodiscard]] std::uint64_t next() const {
    if (change_ + 1 < all_[at_]->changes()) return all_[at_]->time(change_ + 1);
    return at_ + 1 < all_.size() ? all_[at_ + 1]->time(0) : UINT64_MAX;
  }
  void step() {
    if (++change_ == all_[at_]->changes()) {
      ++at_;
      change_ = 0;
    }
    read();
  }

 private:
  void read() { bits_ = view_.bits(all_[at_]->value(change_)); }

  const View& view_;
  std::vector<Tracks::Shared> all_;
  std::size_t at_ = 0, change_ = 0;
  std::string bits_;
};

bool is_bit(const View& v) {
  return v.width == 1 && !v.signal.text && !v.signal.real;
}

bool unknown(std::string_view bits) {
  return bits.find_first_of("xz") != std::string_view::npos;
}

/// The text of bits that are already extracted.
std::string text_of(const View& v, const std::string& bits) {
  View whole = v;
  whole.signal.width = 0;
  return printable_name(whole.text(bits));
}

}  // namespace

std::size_t Scale::column(std::uint64_t time) const {
  return static_cast<std::size_t>(Wide{time - from_} * columns_ / span_);
}

std::uint64_t Scale::first(std::size_t column) const {
  return from_ + static_cast<std::uint64_t>((Wide{column} * span_ + columns_ - 1) / columns_);
}

std::uint64_t Scale::time(std::size_t column) const {
  const std::uint64_t begin = first(column);
  return begin < first(column + 1)
             ? begin
             : from_ + static_cast<std::uint64_t>(Wide{column} * span_ / columns_);
}

std::optional<std::size_t> Wave::missing(const Scale& scale) {
  const std::size_t last = tracks_->block_of(scale.to());
  complete_ = false;
  if (scale_ != scale) {
    scale_ = scale;
    cells_.assign(scale.columns(), {});
    next_ = tracks_->block_of(scale.from());
  }
  for (; next_ <= last; ++next_) {
    const auto track = tracks_->find(view_.signal.handle, next_);
    if (!track) return next_;
    fill(*track, tracks_->blocks()[next_]);
  }
  complete_ = true;
  return std::nullopt;
}

void Wave::fill(const Track& track, const Stretch& block) {
  // The second file may be shorter. It has nothing after its end.
  if (block.end < scale_->from() || block.begin > scale_->to()) return;
  const std::uint64_t from = std::max(block.begin, scale_->from()),
                      to = std::min(block.end, scale_->to());
  std::size_t change = track.at(from);
  std::string bits(view_.bits(track.value(change)));
  const std::size_t first = scale_->column(from);
  // At the begin of a block, a change is one from the value at the end of the previous block.
  const std::string* const before = !cells_[first].bits.empty() ? &cells_[first].bits
                                    : first > 0                 ? &cells_[first - 1].bits
                                                                : nullptr;
  if (from == block.begin && before != nullptr && !before->empty() && *before != bits)
    ++cells_[first].changes;
  // Several columns may show one time.
  const std::size_t stop =
      to == scale_->to() ? cells_.size() : std::max(scale_->column(to) + 1, scale_->column(to + 1));
  for (std::size_t c = first; c < stop; ++c) {
    const std::uint64_t end = std::min(scale_->first(c + 1), to + 1);
    const std::size_t last = end == 0 || end <= from ? change : track.at(end - 1);
    Cell& cell = cells_[c];
    if (last - change > kLookedAt) {
      cell.changes += 2;
      bits = view_.bits(track.value(last));
    } else {
      for (std::size_t i = change + 1; i <= last; ++i) {
        const std::string whole = track.value(i);
        const std::string_view now = view_.bits(whole);
        if (now == bits) continue;
        bits = now;
        ++cell.changes;
      }
    }
    change = std::max(change, last);
    cell.bits = bits;
  }
}

const std::optional<std::string>& Wave::value(std::uint64_t time) {
  if (time_ != time) {
    time_ = time;
    bits_.reset();
    text_.reset();
  }
  if (!bits_) {
    const Stretch& last = tracks_->blocks().back();
    const std::size_t block = tracks_->block_of(time);
    if (time > last.end || time < tracks_->blocks().front().begin) {
      text_ = "";
      return text_;
    }
    const auto track = tracks_->find(view_.signal.handle, block);
    if (!track) return text_;
    bits_ = view_.bits(track->value(track->at(time)));
    text_ = text_of(view_, *bits_);
  }
  return text_;
}

std::vector<Stretch> differences(Wave& a, Wave& b, std::size_t block) {
  std::vector<Stretch> found;
  const Stretch& within = a.tracks().blocks()[block];
  const std::uint64_t begin = std::max(within.begin, b.tracks().blocks().front().begin),
                      end = std::min(within.end, b.tracks().blocks().back().end);
  if (begin > end) return found;
  Walk x(a, begin, end), y(b, begin, end);
  for (std::uint64_t now = begin;;) {
    const std::uint64_t next = std::min(x.next(), y.next()), until = next > end ? end : next - 1;
    if (x.bits() != y.bits()) {
      if (!found.empty() && found.back().end + 1 == now)
        found.back().end = until;
      else
        found.push_back({now, until});
    }
    if (next > end) return found;
    if (x.next() == next) x.step();
    if (y.next() == next) y.step();
    now = next;
  }
}

const Glyphs& glyphs(bool ascii) {
  static constexpr Glyphs kUnicode = {"▔", "▁", "╱", "╲", "╳", "▒", "░", "·", "…", "╷"},
                          kAscii = {"-", "_", "/", "\\", "|", "#", "?", ".", "~", "|"};
  return ascii ? kAscii : kUnicode;
}

namespace {

void draw_bit(Canvas& canvas, std::size_t row, std::size_t column, const Wave& wave,
              const Glyphs& g, Ink ink) {
  const std::vector<Cell>& cells = wave.cells();
  char before = 'x';
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const char now = cells[c].bits.empty() ? 'x' : cells[c].bits[0];
    const bool edge = c != 0 && cells[c].changes == 1 && now != before;
    const char* glyph = g.unknown;
    Style style{ink};
    if (cells[c].bits.empty()) {
      glyph = wave.complete() ? " " : g.unread;
      style.ink = Ink::kFaint;
    } else if (cells[c].changes > 1) {
      glyph = g.busy;
      style.ink = Ink::kBusy;
    } else if (now != '0' && now != '1') {
      glyph = now == 'z' ? "z" : g.unknown;
      style.ink = Ink::kUnknown;
    } else if (edge && before != 'x' && before != 'z') {
      glyph = now == '1' ? g.rise : g.fall;
    } else {
      glyph = now == '1' ? g.high : g.low;
    }
    canvas.put(row, column + c, glyph, style);
    before = now;
  }
}

void draw_bus(Canvas& canvas, std::size_t row, std::size_t column, const Wave& wave,
              const Glyphs& g, Ink ink) {
  const std::vector<Cell>& cells = wave.cells();
  std::string bits, text;
  for (std::size_t c = 0; c < cells.size();) {
    std::size_t stop = c + 1;
    while (stop < cells.size() && cells[stop].changes == 0 &&
           cells[stop].bits.empty() == cells[c].bits.empty())
      ++stop;
    if (cells[c].bits.empty()) {
      for (; c < stop && !wave.complete(); ++c)
        canvas.put(row, column + c, g.unread, {Ink::kFaint});
      c = stop;
      continue;
    }
    if (stop - c > 1 && (cells[c].bits != bits || text.empty())) {
      bits = cells[c].bits;
      text = text_of(wave.view(), bits);
    }
    const bool bad = !wave.view().signal.text && !wave.view().signal.real && unknown(cells[c].bits);
    const Style style{bad ? Ink::kUnknown : ink};
    // A value that began earlier is drawn from the edge of the screen.
    std::size_t at = c;
    if (cells[c].changes > 1)
      canvas.put(row, column + at++, g.busy, {Ink::kBusy});
    else if (cells[c].changes == 1)
      canvas.put(row, column + at++, g.change, style);
    if (stop - c > 1)
      canvas.put(row, column + at, cut_end(text, stop - at, g.cut), style);
    else if (at < stop)
      canvas.put(row, column + at, g.cut, style);
    c = stop;
  }
}

}  // namespace

void draw_wave(Canvas& canvas, std::size_t row, std::size_t column, const Wave& wave,
               const Glyphs& g, Ink ink) {
  if (is_bit(wave.view()) && wave.view().form.kind != Form::Kind::kFloat)
    draw_bit(canvas, row, column, wave, g, ink);
  else
    draw_bus(canvas, row, column, wave, g, ink == Ink::kWave ? Ink::kBus : ink);
}

std::size_t widest(const View& v) {
  if (v.signal.real || v.signal.text) return 12;
  switch (v.form.kind) {
    case Form::Kind::kBinary:
      return v.width;
    case Form::Kind::kUnsigned:
    case Form::Kind::kSigned:
      return v.width * 3 / 10 + 2;
    case Form::Kind::kFloat:
      return 10 + 7 * (v.width / std::max(1u, static_cast<unsigned>(v.form.format.width())) - 1);
    case Form::Kind::kNames: {
      std::size_t most = (v.width + 3) / 4;
      for (const auto& [bits, name] : *v.form.names) most = std::max(most, name.size());
      return most;
    }
    case Form::Kind::kHex:
    case Form::Kind::kFile:
      break;
  }
  return (v.width + 3) / 4;
}

}  // namespace cde::wave::tui
