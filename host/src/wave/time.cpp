// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/value.hpp"

namespace cde::wave {
namespace {

struct Unit {
  std::string_view name;
  int exponent;
};
constexpr std::array<Unit, 6> kUnits = {
    {{"s", 0}, {"ms", -3}, {"us", -6}, {"ns", -9}, {"ps", -12}, {"fs", -15}}};

}  // namespace

std::string Times::text(std::uint64_t time) const {
  const std::int64_t zero = trace_.time_zero();
  const std::uint64_t before = zero < 0 ? 0 - static_cast<std::uint64_t>(zero) : 0;
  if (time < before) return "-" + span(before - time);
  return span(time + static_cast<std::uint64_t>(zero));
}

std::int64_t Times::number(std::uint64_t time) const {
  return static_cast<std::int64_t>(time + static_cast<std::uint64_t>(trace_.time_zero()));
}

std::string Times::span(std::uint64_t length) const {
  std::string digits = fmt::to_string(length);
  const int scale = trace_.scale();
  if (length == 0) return "0";
  // The largest unit that leaves a digit before the point.
  const int top = scale + static_cast<int>(digits.size()) - 1;
  const auto unit = std::find_if(kUnits.begin(), kUnits.end() - 1,
                                 [&](const Unit& u) { return u.exponent <= top; });
  const int point = unit->exponent - scale;  // digits after the point
  if (point <= 0)
    return digits + std::string(static_cast<std::size_t>(-point), '0') + std::string(unit->name);
  const auto behind = static_cast<std::size_t>(point);
  if (digits.size() <= behind) digits.insert(0, behind + 1 - digits.size(), '0');
  std::string fraction = digits.substr(digits.size() - behind);
  while (fraction.ends_with('0')) fraction.pop_back();
  return digits.substr(0, digits.size() - behind) + (fraction.empty() ? "" : ".") + fraction +
         std::string(unit->name);
}

std::optional<double> Times::length(const std::string& text) const {
  double value = 0;
  const char* const stop = text.data() + text.size();
  const auto read = std::from_chars(text.data(), stop, value);
  if (read.ec != std::errc() || !(value >= 0) || !std::isfinite(value)) return std::nullopt;
  const std::string_view unit(read.ptr, static_cast<std::size_t>(stop - read.ptr));
  if (unit.empty()) return value;
  const auto found =
      std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == unit; });
  if (found == kUnits.end()) return std::nullopt;
  // Powers of ten up to 22 are exact, so whole units stay whole.
  const int power = found->exponent - trace_.scale();
  return power >= 0 ? value * std::pow(10, power) : value / std::pow(10, -power);
}

const Signal* Times::clock_if_any() {
  if (!clock_.empty()) return &find_signal(trace_, clock_);
  constexpr std::array<std::string_view, 5> kNames = {"clk_i", "clk", "clock", "aclk", "i_clk"};
  const Signal* best = nullptr;
  const auto depth = [](const Signal& s) { return std::count(s.name.begin(), s.name.end(), '.'); };
  for (const Signal& s : trace_.signals()) {
    if (s.width != 1) continue;
    const std::string_view own = std::string_view(s.name).substr(s.name.rfind('.') + 1);
    if (std::find(kNames.begin(), kNames.end(), own) == kNames.end()) continue;
    if (best == nullptr || depth(s) < depth(*best)) best = &s;
  }
  return best;
}

const Signal& Times::clock() {
  const Signal* const found = clock_if_any();
  if (found == nullptr)
    throw_usage("cycles need a clock, and no signal looks like one: --clock SIGNAL");
  if (found->width != 1)
    throw_usage(
        fmt::format("{} has {} bits; a clock has 1", printable_name(found->name), found->width));
  return *found;
}

const std::vector<std::uint64_t>& Times::edges() {
  if (edges_) return *edges_;
  edges_.emplace();
  char before = 'x';
  trace_.stream(std::array{clock().handle}, trace_.start(), trace_.end(),
                [&](std::uint64_t time, std::uint32_t, std::string_view value) {
                  if (value[0] == '1' && before == '0') edges_->push_back(time);
                  before = value[0];
                  return true;
                });
  return *edges_;
}

std::optional<std::uint64_t> Times::cycle(std::uint64_t time) {
  const auto& all = edges();
  const auto after = std::upper_bound(all.begin(), all.end(), time);
  if (after == all.begin()) return std::nullopt;
  return static_cast<std::uint64_t>(after - all.begin()) - 1;
}

std::uint64_t Times::edge(std::uint64_t number, const std::string& whole) {
  const auto& all = edges();
  if (number >= all.size())
    throw_usage(fmt::format(
        "{} is outside of the file: {} {}", in_quotes(whole), printable_name(clock().name),
        all.empty()
            ? "never rises"
            : fmt::format("rises {} times, the last is cyc:{}", all.size(), all.size() - 1)));
  return all[number];
}

void Times::outside(const std::string& whole) const {
  throw_usage(fmt::format("{} is outside of the file, which goes from {} to {}", in_quotes(whole),
                          text(trace_.start()), text(trace_.end())));
}

/// Converts a number as people count to a number of the file.
std::uint64_t Times::from_zero(bool negative, std::uint64_t magnitude,
                               const std::string& whole) const {
  const std::int64_t zero = trace_.time_zero();
  const std::uint64_t shift =
      zero < 0 ? 0 - static_cast<std::uint64_t>(zero) : static_cast<std::uint64_t>(zero);
  if (!negative && zero <= 0) {
    if (magnitude > UINT64_MAX - shift) outside(whole);
    return magnitude + shift;
  }
  if (negative && zero <= 0 && magnitude <= shift) return shift - magnitude;
  if (negative || magnitude < shift) outside(whole);
  return magnitude - shift;
}

std::uint64_t Times::base(const std::string& text, const std::string& whole) {
  if (text == "start") return trace_.start();
  if (text == "end") return trace_.end();
  if (text == "fail") {
    for (const std::string& comment : trace_.comments())
      if (comment.starts_with("fail "))
        if (const auto found = length(comment.substr(5)))
          return static_cast<std::uint64_t>(std::llround(*found));
    throw_usage("the file does not say when something failed: it has no comment `fail TIME`");
  }
  if (text.starts_with("cyc:")) {
    std::uint64_t number = 0;
    const auto read = std::from_chars(text.data() + 4, text.data() + text.size(), number);
    if (text.size() > 4 && read.ec == std::errc() && read.ptr == text.data() + text.size())
      return edge(number, whole);
  }
  const bool negative = text.starts_with('-');
  const std::string digits = text.substr(negative ? 1 : 0);
  if (digits.find_first_not_of("0123456789") == std::string::npos) {
    std::uint64_t number = 0;
    if (std::from_chars(digits.data(), digits.data() + digits.size(), number).ec == std::errc() &&
        !digits.empty())
      return from_zero(negative, number, whole);
  }
  const auto found = length(digits);
  if (!found || *found > 1.8e19)
    throw_usage(
        fmt::format("no time {}; it must be a number, in units of the file or with fs, ps, ns, us, "
                    "ms or s, cyc:N, start, end or fail, optionally followed by +N or -N",
                    in_quotes(whole)));
  return from_zero(negative, static_cast<std::uint64_t>(*found + 0.5), whole);
}

void warn_if_cut(const Trace& trace, const Times& times) {
  if (trace.ending().empty()) return;
  // A block of an FST has whole instants.
  const std::string half = trace.format() != "VCD" ? ""
                                                   : fmt::format("; changes at {} may be missing",
                                                                 times.text(trace.end()));
  log(fmt::format("cde: warning: {}: {}{}\n", printable_name(trace.file().string()),
                  printable_name(trace.ending()), half));
}

std::uint64_t Times::parse(const std::string& whole) {
  // A sign after an e belongs to the exponent.
  std::size_t sign = whole.find_first_of("+-", 1);
  const std::size_t first = whole.starts_with('-') ? 1 : 0;
  if (sign != std::string::npos && (whole[sign - 1] == 'e' || whole[sign - 1] == 'E') &&
      whole.size() > first && std::isdigit(static_cast<unsigned char>(whole[first])) != 0)
    sign = whole.find_first_of("+-", sign + 1);
  std::uint64_t time = base(whole.substr(0, sign), whole);
  if (sign != std::string::npos) {
    const std::string offset = whole.substr(sign + 1);
    const bool back = whole[sign] == '-';
    if (offset.ends_with("cyc")) {
      std::uint64_t number = 0;
      const char* const stop = offset.data() + offset.size() - 3;
      const auto read = std::from_chars(offset.data(), stop, number);
      if (read.ec != std::errc() || read.ptr != stop) (void)base("", whole);
      const std::uint64_t now = cycle(time).value_or(0);
      if (back && number > now)
        throw_usage(fmt::format("{} is before the first cycle", in_quotes(whole)));
      time = edge(back ? now - number : now + number, whole);
    } else {
      const auto by = length(offset);
      if (!by || *by > 1.8e19) (void)base("", whole);
      const auto steps = static_cast<std::uint64_t>(*by + 0.5);
      if (back ? steps > time : steps > UINT64_MAX - time)
        throw_usage(fmt::format("{} is outside of the file", in_quotes(whole)));
      time = back ? time - steps : time + steps;
    }
  }
  if (time < trace_.start() || time > trace_.end()) outside(whole);
  return time;
}

}  // namespace cde::wave
