// SPDX-License-Identifier: Apache-2.0
#include "wave/vcd_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <type_traits>
#include <utility>

#include "cde/support/message.hpp"
#include "cde/wave/fst_api.hpp"
#include "wave/port_states.hpp"

namespace cde::wave {
namespace {

constexpr std::uint64_t kLeastBetween = 1u << 20;  ///< bytes between two points
constexpr std::uint64_t kMostPoints = 64u << 20;   ///< bytes of all points together
constexpr std::size_t kMostComments = 1000;        ///< comments among the changes
/// Values of signals of this width and more count for the limit below.
constexpr std::uint32_t kWide = 1u << 13;
/// Bits that all short values of wide signals may gain by extension, besides 64 per byte of the
/// file. A value of few digits is extended to the width of its signal.
constexpr std::uint64_t kMostExtension = std::uint64_t{1} << 30;
constexpr std::string_view kStates = "01xzXZUWLHuwlh-";

/// Extends or cuts bits to the signal's width by VCD's rule: 0 before 1, else the first bit
/// repeated. False if significant bits would be cut.
bool fit_bits(std::string_view value, std::uint32_t width, std::string& to) {
  if (value.empty()) value = "0";
  if (value.size() > width) {
    const std::string_view more = value.substr(0, value.size() - width);
    if (more.find_first_not_of(more[0]) != std::string_view::npos) return false;
    if (more[0] == '1' && value[more.size()] != '1') return false;
    value.remove_prefix(more.size());
  }
  to.assign(width - value.size(), value[0] == '1' ? '0' : value[0]);
  to += value;
  for (char& c : to)
    if (c == 'X' || c == 'Z') c = static_cast<char>(c - 'X' + 'x');
  return true;
}

bool is_real_text(std::string_view value) {
  if (value.starts_with('+')) value.remove_prefix(1);
  double number = 0;
  const auto read = std::from_chars(value.data(), value.data() + value.size(), number);
  return read.ptr == value.data() + value.size() && !value.empty() &&
         read.ec != std::errc::invalid_argument;
}

/// The shortest decimal of the same number, as for FST.
std::string real_text(std::string_view value) {
  if (value.starts_with('+')) value.remove_prefix(1);
  double number = 0;
  const auto read = std::from_chars(value.data(), value.data() + value.size(), number);
  return read.ec == std::errc() ? fmt::format("{}", number) : std::string(value);
}

bool unknown_value(std::string_view value) {
  return value.find_first_of("01") == std::string_view::npos;
}

/// The first pass: checks the whole file and notes the places of values.
class VcdIndex : public VcdEvents {
 public:
  VcdIndex(const VcdBody& body, const VcdHeader& header, std::uint64_t file_bytes)
      : body_(body), header_(header), most_extension_(kMostExtension + 64 * file_bytes) {
    last_.resize(header.identifiers.size() + 1, 0);
    seen.resize(last_.size(), 0);
  }

  bool time(std::uint64_t now) override {
    if (any_ && now < now_) body_.fail(fmt::format("time goes back from {} to {}", now_, now));
    if (!any_) start = now;
    if (any_ && body_.offset() - point_ >= between_) {
      points.push_back({body_.offset(), body_.line(), now, now_, last_});
      point_ = body_.offset();
      if (points.size() * last_.size() * sizeof(std::uint64_t) > kMostPoints) thin();
    }
    any_ = true;
    now_ = now;
    return true;
  }
  bool change(std::uint32_t handle, char kind, std::string_view value, bool dumped) override {
    check(handle, kind, value);
    if (header_.types[handle - 1] != FST_VT_VCD_EVENT || !dumped) last_[handle] = body_.offset();
    return true;
  }
  void dumps(bool on) override {
    if (!on && !off_) blackouts.push_back({now_, now_});
    if (on && off_) blackouts.back().to = now_;
    off_ = !on;
  }
  void comment(std::string text) override {
    if (comments.size() < kMostComments)
      comments.push_back(std::move(text));
    else
      ++more_comments;
  }
  /// Called after the last time.
  void finish() {
    if (off_) blackouts.back().to = now_;
    if (more_comments != 0)
      comments.push_back(fmt::format("({} more comments are omitted)", more_comments));
  }
  [[nodiscard]] std::uint64_t now() const { return now_; }

  std::uint64_t start = 0, more_comments = 0;
  std::vector<VcdSource::Point> points;
  std::vector<Blackout> blackouts;
  std::vector<std::string> comments;
  std::vector<unsigned char> seen;  ///< VcdSource::Seen, by handle

 private:
  void check(std::uint32_t handle, char kind, std::string_view value) {
    unsigned char& s = seen[handle];
    if (kind == 's') {
      s |= VcdSource::kText;
      return;
    }
    if (kind == 'r') {
      if (!is_real_text(value))
        body_.fail(fmt::format("{} is not a number; expected r and a decimal", in_quotes(value)));
      s |= VcdSource::kReal;
    } else if (kind == 'p') {
      s |= VcdSource::kBits;
    } else {
      const std::size_t bad = value.find_first_not_of(kStates);
      if (bad != std::string_view::npos)
        body_.fail(fmt::format("value {}; expected 0, 1, x, z, or U, W, L, H, - of VHDL",
                               in_quotes(value)));
      s |= unknown_value(value) ? VcdSource::kUnknown : VcdSource::kBits;
      const std::uint32_t width = header_.widths[handle - 1];
      if (value.size() > width && width != 0 && !fit_bits(value, width, scratch_))
        body_.fail(fmt::format("a value of {} bits for a signal of {}", value.size(), width));
      if (width >= kWide && value.size() < width) check_extension(width - value.size());
    }
    if ((s & VcdSource::kBits) != 0 && (s & VcdSource::kReal) != 0)
      body_.fail("a value of bits and one of a real number for the same signal");
  }
  void check_extension(std::uint64_t bits) {
    if ((extension_ += bits) > most_extension_)
      body_.fail(
          fmt::format("short values of signals of {} bits or more: extended to their "
                      "signals' widths they gain {} bits so far; expected at most {}",
                      kWide, extension_, most_extension_));
  }
  /// Drops every second point.
  void thin() {
    between_ *= 2;
    std::vector<VcdSource::Point> kept;
    for (std::size_t i = 1; i < points.size(); i += 2) kept.push_back(std::move(points[i]));
    points = std::move(kept);
  }

  const VcdBody& body_;
  const VcdHeader& header_;
  std::vector<std::uint64_t> last_;
  std::string scratch_;
  std::uint64_t now_ = 0, point_ = 0, between_ = kLeastBetween;
  bool any_ = false, off_ = false;
  std::uint64_t extension_ = 0, most_extension_;
};

/// Reads a window: the changes of some handles.
class VcdWindow : public VcdEvents {
 public:
  VcdWindow(const std::vector<VcdSource::Kind>& kinds, std::span<const std::uint32_t> handles,
            std::uint64_t to, const WaveSource::Change& visit)
      : kinds_(kinds), wanted_(kinds.size(), false), to_(to), visit_(visit) {
    for (const std::uint32_t h : handles) wanted_[h] = true;
  }
  /// Sets the current time. If `only` is not 0, only that handle counts.
  void set(std::uint64_t now, std::uint32_t only) {
    now_ = now;
    only_ = only;
  }
  bool time(std::uint64_t now) override {
    // Values before the first time belong to it.
    now_ = std::max(now_, now);
    return now <= to_;
  }
  bool change(std::uint32_t handle, char kind, std::string_view value, bool dumped) override {
    if (!wanted_[handle] || (only_ != 0 && handle != only_)) return true;
    const VcdSource::Kind& k = kinds_[handle];
    if (k.event) {
      if (!dumped && value == "1") go_on_ = visit_(now_, handle, "1");
      return go_on_;
    }
    if (k.text) {
      own_ = value;
      if (kind == 's') {
        // The decoder reads beyond an escape at the end.
        own_.append(4, '\0');
        own_.resize(static_cast<std::size_t>(
            fstUtilityEscToBin(nullptr, reinterpret_cast<unsigned char*>(own_.data()),
                               static_cast<int>(value.size()))));
      }
    } else if (k.real) {
      own_ = kind == 'r' ? real_text(value) : "x";
    } else if (kind == 'p') {
      port_bits(value, k.width, own_);
    } else {
      (void)fit_bits(value, k.width, own_);
    }
    go_on_ = visit_(now_, handle, own_);
    return go_on_;
  }
  [[nodiscard]] bool go_on() const { return go_on_; }

 private:
  const std::vector<VcdSource::Kind>& kinds_;
  std::vector<bool> wanted_;
  std::uint64_t to_, now_ = 0;
  const WaveSource::Change& visit_;
  std::string own_;
  std::uint32_t only_ = 0;
  bool go_on_ = true;
};

}  // namespace

VcdSource::VcdSource(WaveBytes file) : file_(std::move(file)) {
  WordReader words(file_);
  VcdHeader header = read_vcd_header(words);
  factor_ = header.factor;
  std::string_view word;
  const bool more = words.next(word);
  body_ = more ? words.offset() : file_.size();
  body_line_ = words.line();
  if (more) words.again();
  identifiers_ = std::make_unique<VcdIdentifiers>(header.identifiers);
  VcdBody body(words, *identifiers_, factor_);
  VcdIndex index(body, header, file_.size());
  bool cut = false;
  try {
    body.run(index);
  } catch (const VcdCut&) {
    cut = true;
    facts_.ending = fmt::format(
        "the file ends within line {}, at byte {}, which is ignored: the simulation still runs, or "
        "was killed",
        words.line(), file_.size());
  }
  index.finish();
  facts_.format = "VCD";
  facts_.scale = header.scale;
  facts_.time_zero = header.time_zero;
  facts_.start = index.start;
  facts_.end = index.now();
  facts_.writer = std::move(header.writer);
  facts_.date = std::move(header.date);
  facts_.handles = static_cast<std::uint32_t>(header.identifiers.size());
  facts_.blackouts = std::move(index.blackouts);
  facts_.structure.bytes = file_.size();
  facts_.structure.closed = !cut;
  points_ = std::move(index.points);
  std::uint64_t begin = facts_.start;
  for (const Point& p : points_) {
    facts_.structure.sections.push_back({begin, p.time});
    begin = p.time;
  }
  facts_.structure.sections.push_back({begin, facts_.end});
  names_ = std::move(header.names);
  for (std::string& text : index.comments)
    names_.emplace_back(Attribute{FST_AT_MISC, FST_MT_COMMENT, std::move(text), 0});
  kinds_.resize(facts_.handles + std::size_t{1});
  for (std::size_t h = 1; h < kinds_.size(); ++h) {
    const int type = header.types[h - 1];
    kinds_[h] = {type == FST_VT_VCD_REAL || type == FST_VT_VCD_REAL_PARAMETER ||
                     type == FST_VT_VCD_REALTIME || type == FST_VT_SV_SHORTREAL,
                 type == FST_VT_GEN_STRING, type == FST_VT_VCD_EVENT, header.widths[h - 1]};
  }
  settle_kinds(index.seen);
}

/// Some writers declare texts as reals, and reals as bits, so the values decide.
void VcdSource::settle_kinds(const std::vector<unsigned char>& seen) {
  for (std::size_t h = 1; h < kinds_.size(); ++h) {
    Kind& k = kinds_[h];
    if (k.event) continue;
    if ((seen[h] & kText) != 0) k.text = true;
    if (k.text) {
      k.real = false;
      k.width = 0;
    } else if ((seen[h] & kReal) != 0) {
      k.real = true;
      k.width = 64;
    } else if (k.real && (seen[h] & kBits) != 0) {
      k.real = false;  // it keeps its width of 64
    }
  }
  for (VcdName& name : names_)
    if (auto* const v = std::get_if<VariableName>(&name)) {
      const Kind& k = kinds_[v->handle];
      const bool real = v->type == FST_VT_VCD_REAL || v->type == FST_VT_VCD_REAL_PARAMETER ||
                        v->type == FST_VT_VCD_REALTIME || v->type == FST_VT_SV_SHORTREAL;
      if (k.text)
        v->type = FST_VT_GEN_STRING;
      else if (k.real && !real)
        v->type = FST_VT_VCD_REAL;
      else if (!k.real && real)
        v->type = FST_VT_VCD_WIRE;
      v->width = k.width;
    }
}

void VcdSource::names(const SourceVisit& visit) {
  for (const VcdName& name : names_)
    std::visit(
        [&](const auto& n) {
          using Type = std::decay_t<decltype(n)>;
          Type own = n;
          if constexpr (std::is_same_v<Type, ScopeName>) {
            if (visit.open) visit.open(std::move(own));
          } else if constexpr (std::is_same_v<Type, ScopeEnd>) {
            if (visit.close) visit.close();
          } else if constexpr (std::is_same_v<Type, VariableName>) {
            if (visit.variable) visit.variable(std::move(own));
          } else {
            if (visit.attribute) visit.attribute(std::move(own));
          }
        },
        name);
}

void VcdSource::changes(std::span<const std::uint32_t> handles, std::uint64_t from,
                        std::uint64_t to, const Change& visit) {
  VcdWindow window(kinds_, handles, to, visit);
  const auto after = std::upper_bound(points_.begin(), points_.end(), from,
                                      [](std::uint64_t t, const Point& p) { return t < p.time; });
  WordReader words(file_);
  VcdBody body(words, *identifiers_, factor_);
  try {
    if (after == points_.begin()) {
      window.set(facts_.start, 0);
      words.seek(body_, body_line_);
    } else {
      const Point& point = *std::prev(after);
      std::vector<std::pair<std::uint64_t, std::uint32_t>> places;
      for (const std::uint32_t h : handles)
        if (point.last[h] != 0) places.emplace_back(point.last[h], h);
      std::sort(places.begin(), places.end());
      // Values are far apart, so read little at a time.
      WordReader few(file_, 4096);
      VcdBody one(few, *identifiers_, factor_);
      for (const auto& [offset, handle] : places) {
        few.seek(offset, 0);
        window.set(point.before, handle);
        (void)one.step(window);
        if (!window.go_on()) return;
      }
      window.set(point.before, 0);
      words.seek(point.offset, point.line);
    }
    body.run(window);
  } catch (const VcdCut&) {
    // the first pass has reported it
  }
}

}  // namespace cde::wave
