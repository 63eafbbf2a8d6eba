// SPDX-License-Identifier: Apache-2.0
// cde wave tx: lists transactions in a card's waves as a table, CSV, JSON or histogram.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "cde/support/columns.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suggest.hpp"
#include "cde/wave/card_signals.hpp"
#include "cde/wave/filter.hpp"
#include "cde/wave/transaction.hpp"
#include "commands/commands.hpp"
#include "output/streams.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

void check(const Request& r) {
  const auto& kinds = transaction_kinds();
  for (const std::string& w : r.words)
    if (std::find(kinds.begin(), kinds.end(), w) == kinds.end())
      throw Error(ErrorCode::kUsage, fmt::format("no kind of transactions {}; {}", in_quotes(w),
                                                 suggestion_text(w, kinds)));
  const auto names = field_names(r.words);
  if (!r.histogram.empty() && std::find(names.begin(), names.end(), r.histogram) == names.end())
    throw Error(ErrorCode::kUsage,
                fmt::format("--histogram: no field {}; {}", in_quotes(r.histogram),
                            suggestion_text(r.histogram, names)));
}

/// The kinds of transactions in a file, and why requested kinds are missing.
struct There {
  std::vector<std::string> kinds;
  std::string lacks;
};

There there(Trace& trace, const std::vector<std::string>& asked) {
  const SignalPlaces places(trace);
  There found;
  for (const KindSignals& k : card_signals()) {
    if (!places.of(k).empty()) {
      found.kinds.emplace_back(k.kind);
      continue;
    }
    if (std::find(asked.begin(), asked.end(), k.kind) == asked.end()) continue;
    const auto missing = places.missing(k);
    const bool all = missing.size() == k.clocks.size() + k.signals.size() + k.arrays.size();
    found.lacks += fmt::format(
        "cde: the file does not have the signals for {}: {}\n", k.kind,
        all ? fmt::format("no scope has a signal {}",
                          missing[std::min(k.clocks.size(), missing.size() - 1)])
            : fmt::format(
                  "{}{}",
                  fmt::join(missing.begin(),
                            missing.begin() + std::min<std::ptrdiff_t>(3, std::ssize(missing)),
                            ", "),
                  missing.size() > 3 ? ", ..." : ""));
  }
  return found;
}

/// A whole number becomes a JSON number.
Json json_value(const std::string& text) {
  if (!text.empty() && text.size() < 19 &&
      text.find_first_not_of("0123456789") == std::string::npos)
    return std::stoull(text);
  return text;
}

class Output {
 public:
  Output(const Request& r, const Times& times, const There& file)
      : r_(r), times_(times), lines_(r.max) {
    if (r.csv) {
      columns_ = field_names(r.words.empty() ? file.kinds : r.words);
      text_ = fmt::format("{}\n", fmt::join(columns_, ","));
    } else {
      table_.heads = {"begin", "latency", "cycles", "stalls", "kind", "outcome", "what"};
    }
  }

  void add(const Transaction& t) {
    ++counts_[t.kind];
    if (!lines_.next()) return;
    if (r_.json)
      list_.push_back(json(t));
    else if (r_.csv)
      csv(t);
    else
      table_.lines.push_back(
          {times_.text(t.begin), times_.span(t.end - t.begin), field_of(t, "cycles").value_or("-"),
           field_of(t, "stalls").value_or("-"), t.kind, t.outcome, printable_name(t.label)});
  }
  [[nodiscard]] std::uint64_t count() const { return lines_.seen(); }

  void print(const There& file) {
    if (r_.json) {
      Json j = begin_json(r_);
      Json counts = Json::array();
      for (const std::string& k : transaction_kinds())
        if (counts_.contains(k)) counts.push_back({{"transaction", k}, {"count", counts_[k]}});
      j.update({{"kinds", file.kinds},
                {"counts", counts},
                {"transactions", list_},
                {"more", lines_.more()}});
      cli::print_json(j);
      return;
    }
    if (r_.csv) {
      cli::print(text_);
      if (lines_.more() != 0) cli::log("cde: {}", lines_.rest());
      return;
    }
    if (count() == 0) return;
    std::vector<std::string> parts;
    for (const std::string& k : transaction_kinds())
      if (counts_.contains(k)) parts.push_back(fmt::format("{} {}", counts_[k], k));
    cli::print(without_spaces(table_.text()) + lines_.rest() +
               fmt::format("{}\n", fmt::join(parts, ", ")));
  }

 private:
  Json json(const Transaction& t) const {
    Json values = Json::array();
    for (const auto& [name, value] : t.fields)
      values.push_back({{"name", name}, {"value", json_value(value)}});
    return {{"transaction", t.kind},
            {"label", t.label},
            {"scope", t.scope},
            {"begin", times_.number(t.begin)},
            {"end", times_.number(t.end)},
            {"at", times_.text(t.begin)},
            {"latency", t.end - t.begin},
            {"stalls", t.stalls ? Json(*t.stalls) : Json()},
            {"outcome", t.outcome},
            {"values", values}};
  }
  void csv(const Transaction& t) {
    for (std::size_t c = 0; c < columns_.size(); ++c)
      text_ +=
          fmt::format("{}{}", c == 0 ? "" : ",", csv_field(field_of(t, columns_[c]).value_or("")));
    text_ += '\n';
  }

  const Request& r_;
  const Times& times_;
  Lines lines_;
  Columns table_{.heads = {}, .gap = 2, .left = {false, false, false, false, true, true, true}};
  Json list_ = Json::array();
  std::map<std::string, std::uint64_t> counts_;
  std::vector<std::string> columns_;
  std::string text_;
};

/// A histogram of a field. Many different numbers are grouped in steps; other values are listed by
/// name.
class Histogram {
 public:
  explicit Histogram(std::string field) : field_(std::move(field)) {}

  void add(const Transaction& t) {
    const auto text = field_of(t, field_);
    if (!text) {
      ++without_;
      return;
    }
    ++count_;
    const auto number = as_number(*text);
    if (number && std::isfinite(*number))
      ++numbers_[*number];
    else
      ++words_[*text];
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }

  struct Bar {
    std::string name;
    double from = 0, to = 0;
    std::uint64_t count = 0;
    bool number = false;
  };
  [[nodiscard]] std::vector<Bar> bars(const Times& times) const {
    std::vector<Bar> all;
    const auto text = [&](double v) {
      const bool time = field_ == "begin" || field_ == "end" || field_ == "latency";
      return time ? times.text(static_cast<std::uint64_t>(v)) : fmt::format("{}", v);
    };
    if (numbers_.size() <= kMost) {
      for (const auto& [v, n] : numbers_) all.push_back({text(v), v, v, n, true});
    } else {
      const double low = numbers_.begin()->first, high = numbers_.rbegin()->first;
      const double step = nice((high - low) / kMost), start = std::floor(low / step) * step;
      for (const auto& [v, n] : numbers_) {
        const auto at = static_cast<std::size_t>((v - start) / step);
        while (all.size() <= at) {
          const double from = start + static_cast<double>(all.size()) * step;
          all.push_back({text(from) + " ..", from, from + step, 0, true});
        }
        all[at].count += n;
      }
    }
    for (const auto& [w, n] : words_) all.push_back({w, 0, 0, n, false});
    return all;
  }
  /// "least 2, median 7, most 30, sum 124".
  [[nodiscard]] Json summary() const {
    if (numbers_.empty()) return {};
    std::uint64_t total = 0, before = 0;
    double sum = 0, median = 0;
    for (const auto& [v, n] : numbers_) {
      total += n;
      sum += v * static_cast<double>(n);
    }
    for (const auto& [v, n] : numbers_) {
      before += n;
      if (2 * before >= total) {
        median = v;
        break;
      }
    }
    return {{"least", numbers_.begin()->first},
            {"median", median},
            {"most", numbers_.rbegin()->first},
            {"sum", sum}};
  }
  [[nodiscard]] std::uint64_t without() const { return without_; }

 private:
  static constexpr std::size_t kMost = 20;
  /// The least of 1, 2, 5, 10, ... that is not below `step`.
  static double nice(double step) {
    const double ten = std::pow(10, std::floor(std::log10(step)));
    for (const double by : {1.0, 2.0, 5.0})
      if (by * ten >= step) return by * ten;
    return 10 * ten;
  }

  std::string field_;
  std::map<double, std::uint64_t> numbers_;
  std::map<std::string, std::uint64_t> words_;
  std::uint64_t count_ = 0, without_ = 0;
};

void print(const Request& r, const Histogram& h, const Times& times, const There& file) {
  const auto bars = h.bars(times);
  Lines lines(r.max);
  const Json summary = h.summary();
  if (r.json) {
    Json list = Json::array();
    for (const auto& b : bars)
      if (lines.next())
        list.push_back(b.number ? Json{{"least", b.from}, {"most", b.to}, {"count", b.count}}
                                : Json{{"value", b.name}, {"count", b.count}});
    Json j = begin_json(r);
    j.update({{"kinds", file.kinds},
              {"field", r.histogram},
              {"count", h.count()},
              {"summary", summary},
              {"bars", list},
              {"more", lines.more()}});
    cli::print_json(j);
    return;
  }
  std::size_t name = 0, digits = 0;
  std::uint64_t most = 1;
  for (const auto& b : bars) {
    name = std::max(name, b.name.size());
    digits = std::max(digits, fmt::to_string(b.count).size());
    most = std::max(most, b.count);
  }
  const std::size_t columns = r.columns == 0 ? 80 : r.columns;
  const std::size_t room = columns > name + digits + 14 ? columns - name - digits - 4 : 10;
  std::string text;
  for (const auto& b : bars) {
    if (!lines.next()) continue;
    const auto length = static_cast<std::size_t>(std::ceil(
        static_cast<double>(room) * static_cast<double>(b.count) / static_cast<double>(most)));
    std::string bar;
    for (std::size_t i = 0; i < length; ++i) bar += r.ascii ? "#" : "█";
    text += fmt::format("{:>{}}  {:>{}}  {}\n", printable_name(b.name), name, b.count, digits, bar);
  }
  text += lines.rest();
  if (!summary.is_null()) {
    const bool time = r.histogram == "begin" || r.histogram == "end" || r.histogram == "latency";
    const auto shown = [&](const char* key) {
      const double v = summary[key].get<double>();
      return time ? times.text(static_cast<std::uint64_t>(v)) : fmt::format("{}", v);
    };
    text += fmt::format("{} of {}: least {}, median {}, most {}, sum {}\n", h.count(), r.histogram,
                        shown("least"), shown("median"), shown("most"), shown("sum"));
  }
  if (h.without() != 0) text += fmt::format("{} without {}\n", h.without(), r.histogram);
  cli::print(without_spaces(text));
}

}  // namespace

int transaction_table(const Request& r) {
  check(r);
  Trace trace(r.file);
  Times times(trace, r.clock);
  warn_if_cut(trace, times);
  const Window w = window(r, trace, times);
  std::optional<Filter> filter;
  if (!r.where.empty()) filter.emplace(r.where, r.words, times);
  const There file = there(trace, r.words);
  Output output(r, times, file);
  Histogram histogram(r.histogram);
  const bool bars = !r.histogram.empty();
  each_transaction(trace, r.words, w.from, w.to, [&](const Transaction& t) {
    if (filter && !filter->matches(t)) return true;
    if (bars)
      histogram.add(t);
    else
      output.add(t);
    return true;
  });
  if (bars)
    print(r, histogram, times, file);
  else
    output.print(file);
  if (!file.lacks.empty()) cli::log("{}", file.lacks);
  if ((bars ? histogram.count() : output.count()) != 0) return 0;
  cli::log("cde: no transactions found; the file has {}\n",
           file.kinds.empty() ? "none of the card's signals that they need"
                              : fmt::format("the kinds {}", fmt::join(file.kinds, ", ")));
  return 1;
}

}  // namespace cde::wave
