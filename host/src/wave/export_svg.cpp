// SPDX-License-Identifier: Apache-2.0
// Draws waves as a self-contained SVG picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/xml_text.hpp"
#include "cde/wave/blackouts.hpp"
#include "cde/wave/changes.hpp"
#include "cde/wave/export.hpp"
#include "cde/wave/export_names.hpp"
#include "cde/wave/four_state.hpp"
#include "cde/wave/request.hpp"

namespace cde::wave {
namespace {

constexpr std::size_t kMostSignals = 500;
constexpr double kRow = 26, kWave = 16, kScope = 22, kHead = 58, kLetter = 7.25, kEdge = 3;
/// Changes closer than this are drawn as one.
constexpr double kNear = 2.5;

constexpr std::string_view kStyle = R"(
  svg{font:12px ui-monospace,'DejaVu Sans Mono',Consolas,monospace;background:#fff}
  .back{fill:#fff}.title{font-weight:bold}text{fill:#1c2430}.scope,.tick{fill:#5b6675}.tick{font-size:11px}
  .grid{stroke:#e3e7ec;stroke-width:1}.band{fill:#f6f8fa}.wave{fill:none;stroke:#0b6bcb;stroke-width:1.5}
  .bus{fill:#eaf3fc;stroke:#0b6bcb;stroke-width:1}.odd{fill:#fde8e8;stroke:#c22f2f}.busy{fill:#0b6bcb}
  .unknown{fill:#f6c4c4;stroke:#c22f2f}.high{fill:none;stroke:#b7791f;stroke-width:1.5;stroke-dasharray:3 2}
  .dark{fill:#5b6675;fill-opacity:.16}.fail{stroke:#c22f2f;stroke-width:1.5;stroke-dasharray:5 3}.failed{fill:#c22f2f;font-weight:bold}.value{font-size:11px}
  @media (prefers-color-scheme:dark){svg{background:#14181f}.back{fill:#14181f}text{fill:#dde4ee}.scope,.tick{fill:#93a0b2}
  .grid{stroke:#2a313c}.band{fill:#1a2029}.wave{stroke:#5db0ff}.bus{fill:#172b40;stroke:#5db0ff}.odd{fill:#451d20;stroke:#ff7b7b}
  .busy{fill:#5db0ff}.unknown{fill:#5a2327;stroke:#ff7b7b}.fail{stroke:#ff7b7b}.failed{fill:#ff7b7b}}
)";

/// Counts characters, not bytes.
std::size_t letters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u;
  }));
}
/// The text with at most this many characters, and a mark if it is cut.
std::string shortened(const std::string& text, std::size_t most) {
  if (letters(text) <= most) return text;
  if (most < 2) return "";
  std::string kept;
  std::size_t count = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xc0u) != 0x80u && ++count > most - 1) break;
    kept += c;
  }
  return kept + "…";
}

/// A time span in which a signal keeps a value, or changes too often to draw.
struct Stretch {
  double begin = 0;
  std::string value;  ///< the whole value; the last one if busy
  bool busy = false;
};

class Picture {
 public:
  Picture(Trace& trace, Times& times, std::span<const View> views, const Window& w,
          const SvgOptions& options)
      : trace_(trace), times_(times), views_(views), w_(w), options_(options) {
    std::size_t longest = 4;
    std::string scope;
    double y = kHead;
    for (const View& v : views_) {
      const std::string own = scope_of(v);
      if (own != scope) y += kScope;
      scope = own;
      longest =
          std::max({longest, letters(name_of(v)) + 2, std::min<std::size_t>(letters(own), 40)});
      tops_.push_back(y);
      y += kRow;
    }
    height_ = y + 10;
    left_ = std::min(static_cast<double>(longest) * kLetter + 22, options.width * 0.4);
    right_ = options.width - 12.0;
    span_ = std::max<std::uint64_t>(1, w.to - w.from);
  }

  std::string draw() {
    text_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1:.0f}\" viewBox=\"0 0 "
        "{0} {1:.0f}\">\n<style>{2}</style>\n<rect class=\"back\" width=\"{0}\" "
        "height=\"{1:.0f}\"/>\n",
        options_.width, height_, kStyle);
    text_ += fmt::format(
        "<text class=\"title\" x=\"10\" y=\"18\">{}</text>\n",
        xml_text(printable_name(fmt::format("{}, {} to {}", trace_.file().filename().string(),
                                            times_.text(w_.from), times_.text(w_.to)))));
    bands();
    ruler();
    names();
    dark();
    const std::vector<std::vector<Stretch>> rows = sample();
    for (std::size_t i = 0; i < views_.size(); ++i) row(i, rows[i]);
    marker();
    return text_ + "</svg>\n";
  }

 private:
  [[nodiscard]] static std::string scope_of(const View& v) {
    const std::size_t dot = v.signal.name.rfind('.');
    return dot == std::string::npos ? "" : v.signal.name.substr(0, dot);
  }
  [[nodiscard]] static std::string name_of(const View& v) {
    return v.label.substr(scope_of(v).empty() ? 0 : scope_of(v).size() + 1);
  }
  [[nodiscard]] double x(std::uint64_t time) const {
    return left_ +
           (right_ - left_) * static_cast<double>(time - w_.from) / static_cast<double>(span_);
  }

  void bands() {
    for (std::size_t i = 0; i < views_.size(); i += 2)
      text_ +=
          fmt::format("<rect class=\"band\" x=\"0\" y=\"{:.1f}\" width=\"{}\" height=\"{}\"/>\n",
                      tops_[i], options_.width, kRow);
  }

  /// Marks where the simulation wrote no changes ($dumpoff).
  void dark() {
    for (const Blackout& b : blackouts_in(trace_, w_.from, w_.to))
      text_ += fmt::format(
          "<rect class=\"dark\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\">"
          "<title>not dumped, {} to {}</title></rect>\n",
          x(b.from), kHead, std::max(0.5, x(b.to) - x(b.from)), height_ - 8 - kHead,
          times_.text(b.from), times_.text(b.to));
  }

  void line(const char* kind, double at, double top) {
    text_ += fmt::format("<path class=\"{}\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>\n", kind, at, top,
                         height_ - 8);
  }

  /// Draws times at the top. Draws cycles with a line each below, if there is room.
  void ruler() {
    const double a_pixel = static_cast<double>(span_) / (right_ - left_);
    std::uint64_t step = 1;
    // Steps of 1, 2, 5, 10, ... keep texts apart.
    const auto crowded = [&] {
      const std::uint64_t tick = w_.from + (step - w_.from % step) % step;
      const std::size_t letters =
          std::max(times_.text(tick).size(), times_.text(tick + step).size()) + 3;
      return static_cast<double>(step) < static_cast<double>(letters) * kLetter * a_pixel;
    };
    for (unsigned turn = 0; step < UINT64_MAX / 20 && crowded(); ++turn)
      step = turn % 3 == 1 ? step / 2 * 5 : step * 2;
    for (std::uint64_t t = w_.from + (step - w_.from % step) % step; t <= w_.to && t >= w_.from;
         t += step) {
      const bool fits =
          x(t) + static_cast<double>(times_.text(t).size()) * kLetter < options_.width;
      if (fits)
        text_ += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"36\">{}</text>\n", x(t) + 3,
                             times_.text(t));
      text_ += fmt::format("<path class=\"grid\" d=\"M{:.1f} 27V{}\"/>\n", x(t), 39);
      if (t > UINT64_MAX - step) break;
    }
    if (times_.clock_if_any() == nullptr) return;
    const auto& edges = times_.edges();
    const auto first = std::lower_bound(edges.begin(), edges.end(), w_.from),
               last = std::upper_bound(edges.begin(), edges.end(), w_.to);
    const auto count = static_cast<double>(last - first);
    if (count < 1) return;
    const double room = (right_ - left_) / count;
    const std::string highest = fmt::to_string(edges.size());
    std::uint64_t every = 1;
    for (unsigned turn = 0;
         room * static_cast<double>(every) < (static_cast<double>(highest.size()) + 1.5) * kLetter;
         ++turn)
      every = turn % 3 == 1 ? every / 2 * 5 : every * 2;
    text_ += fmt::format(
        "<text class=\"tick\" x=\"{:.1f}\" y=\"52\" text-anchor=\"end\">cycle"
        "</text>\n",
        left_ - 8);
    for (auto e = first; e != last; ++e) {
      const auto number = static_cast<std::uint64_t>(e - edges.begin());
      const bool named = number % every == 0;
      if (named || room >= 9) line("grid", x(*e), 42);
      if (named && x(*e) + static_cast<double>(highest.size()) * kLetter < options_.width)
        text_ += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"52\">{}</text>\n", x(*e) + 3,
                             number);
    }
  }

  void names() {
    std::string scope;
    const auto most = static_cast<std::size_t>((left_ - 22) / kLetter);
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const std::string own = scope_of(views_[i]);
      if (own != scope && !own.empty())
        text_ +=
            fmt::format("<text class=\"scope\" x=\"10\" y=\"{:.1f}\">{}</text>\n", tops_[i] - 6,
                        xml_text(printable_name(shortened(
                            own, static_cast<std::size_t>((options_.width - 30) / kLetter)))));
      scope = own;
      text_ += fmt::format("<text x=\"20\" y=\"{:.1f}\"><title>{}</title>{}</text>\n",
                           tops_[i] + kRow / 2 + 4, xml_text(printable_name(views_[i].label)),
                           xml_text(shortened(printable_name(name_of(views_[i])), most)));
    }
  }

  [[nodiscard]] std::vector<std::vector<Stretch>> sample() {
    std::vector<std::vector<Stretch>> rows(views_.size());
    std::vector<std::vector<std::size_t>> of(trace_.handles() + std::size_t{1});
    std::vector<std::uint32_t> wanted;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      of[views_[i].signal.handle].push_back(i);
      wanted.push_back(views_[i].signal.handle);
    }
    stream_changes(trace_, wanted, w_.from, w_.to,
                   [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                     for (const std::size_t i : of[handle]) change(rows[i], views_[i], time, value);
                     return true;
                   });
    return rows;
  }
  void change(std::vector<Stretch>& row, const View& v, std::uint64_t time,
              std::string_view value) const {
    const double at = x(time);
    if (v.signal.event) {  // marks that would touch become one
      if (value == "1" && (row.empty() || at - row.back().begin >= 1))
        row.push_back({at, "1", false});
      return;
    }
    if (!row.empty() && v.bits(value) == v.bits(row.back().value)) return;
    if (!row.empty() && time != w_.from) {
      // A stretch that is too short to see is busy. It merges with a busy one before it.
      if (Stretch& last = row.back(); at - last.begin < kNear && row.size() > 1) {
        const std::size_t n = row.size();
        if (row[n - 2].busy) {
          row.pop_back();
        } else {
          last.busy = true;
        }
      }
    }
    row.push_back({at, std::string(value), false});
  }

  void row(std::size_t i, const std::vector<Stretch>& stretches) {
    const View& v = views_[i];
    const bool one = v.width == 1 && !v.signal.real && !v.signal.text;
    const double high = tops_[i] + (kRow - kWave) / 2, low = high + kWave;
    if (v.signal.event) return marks(stretches, high, low);
    std::string path;  // the current line of a bit
    const auto end_path = [&] {
      if (!path.empty()) text_ += fmt::format("<path class=\"wave\" d=\"{}\"/>\n", path);
      path.clear();
    };
    for (std::size_t s = 0; s < stretches.size(); ++s) {
      const double begin = stretches[s].begin,
                   end = s + 1 < stretches.size() ? stretches[s + 1].begin : right_;
      std::string bits(v.bits(stretches[s].value));
      if (one && !bits.empty()) bits[0] = four_state(bits[0]);
      if (stretches[s].busy) {
        end_path();
        box("busy", begin, end, high, low);
      } else if (!one) {
        bus(v, stretches[s].value, bits, {begin, end}, {high, low}, s == 0);
      } else if (bits == "z") {
        end_path();
        text_ += fmt::format("<path class=\"high\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", begin,
                             (high + low) / 2, end);
      } else if (bits != "0" && bits != "1") {
        end_path();
        box("unknown", begin, end, high, low);
      } else {
        const double level = bits == "1" ? high : low;
        path += fmt::format("{}{:.1f} {:.1f}H{:.1f}", path.empty() ? "M" : "L", begin, level, end);
      }
    }
    end_path();
  }
  /// Draws an arrow at each trigger of an event.
  void marks(const std::vector<Stretch>& stretches, double high, double low) {
    std::string path;
    for (const Stretch& s : stretches)
      path +=
          fmt::format("M{0:.1f} {1:.1f}V{2:.1f}M{3:.1f} {4:.1f}L{0:.1f} {2:.1f}L{5:.1f} {4:.1f}",
                      s.begin, low, high, s.begin - 3, high + 4, s.begin + 3);
    if (!path.empty()) text_ += fmt::format("<path class=\"wave event\" d=\"{}\"/>\n", path);
  }
  void box(const char* kind, double begin, double end, double high, double low) {
    text_ += fmt::format(
        "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n", kind,
        begin, high, std::max(0.5, end - begin), low - high);
  }
  /// Draws a bus value: a shape with slanted ends, and as much of its text as fits.
  void bus(const View& v, const std::string& value, const std::string& bits,
           std::pair<double, double> across, std::pair<double, double> levels, bool first) {
    const auto [begin, end] = across;
    const auto [high, low] = levels;
    const bool unknown = !v.signal.text && bits.find_first_not_of("xXzZ") == std::string::npos;
    if (unknown) return box("unknown", begin, end, high, low);
    const std::string text = v.text(value);
    const bool number = v.form.kind == Form::Kind::kFloat;
    const bool odd =
        (number &&
         (text.find("nan") != std::string::npos || text.find("inf") != std::string::npos)) ||
        (!v.signal.real && !v.signal.text && bits.find_first_not_of("01") != std::string::npos);
    const double slant = std::min(kEdge, (end - begin) / 2), middle = (high + low) / 2;
    const double in = first ? 0 : slant;
    text_ += fmt::format(
        "<path class=\"bus{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}H{:.1f}L{:.1f} {:.1f}L{:.1f} "
        "{:.1f}H{:.1f}Z\"/>\n",
        odd ? " odd" : "", begin, middle, begin + in, high, end - slant, end, middle, end - slant,
        low, begin + in);
    const auto room = static_cast<std::size_t>(std::max(0.0, (end - begin - 2 * kEdge - 2) / 6.7));
    const std::string shown = shortened(printable_name(text), room);
    if (!shown.empty())
      text_ += fmt::format("<text class=\"value\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                           begin + kEdge + 2, middle + 4, xml_text(shown));
  }

  void marker() {
    if (!options_.fail || *options_.fail < w_.from || *options_.fail > w_.to) return;
    const double at = x(*options_.fail);
    line("fail", at, 22);
    const bool left = at + 40 > options_.width;
    text_ += fmt::format("<text class=\"failed\" x=\"{:.1f}\" y=\"24\"{}>fail</text>\n",
                         left ? at - 4 : at + 4, left ? " text-anchor=\"end\"" : "");
  }

  Trace& trace_;
  Times& times_;
  std::span<const View> views_;
  Window w_;
  const SvgOptions& options_;
  std::vector<double> tops_;
  double height_ = 0, left_ = 0, right_ = 0;
  std::uint64_t span_ = 1;
  std::string text_;
};

}  // namespace

void write_svg(Trace& trace, Times& times, std::span<const View> views, std::uint64_t from,
               std::uint64_t to, const SvgOptions& options, const std::filesystem::path& path) {
  const std::vector<View> all = views_or_all(trace, views);
  if (all.size() > kMostSignals)
    throw Error(ErrorCode::kUsage,
                fmt::format("a picture has at most {} signals, and {} are selected; name fewer",
                            kMostSignals, all.size()));
  write_file(path, Picture(trace, times, all, {from, to}, options).draw());
}

}  // namespace cde::wave
