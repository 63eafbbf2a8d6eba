// SPDX-License-Identifier: Apache-2.0
#include "cde/explain/explain_text.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <vector>

#include "cde/fp/number_text.hpp"

namespace cde {
namespace {

using explain::Compared;
using explain::Comparison;
using explain::Explanation;
using explain::Finding;
using explain::Step;

bool is_comparison(FpOp op) {
  return op == FpOp::kLt || op == FpOp::kLe || op == FpOp::kEq;
}

const char* sign_of(FpOp op) {
  switch (op) {
    case FpOp::kAdd:
      return "+";
    case FpOp::kSub:
      return "-";
    case FpOp::kMul:
      return "*";
    case FpOp::kDiv:
      return "/";
    case FpOp::kLt:
      return "<";
    case FpOp::kLe:
      return "<=";
    case FpOp::kEq:
      return "==";
    case FpOp::kMin:
      return "min";
    case FpOp::kMax:
      return "max";
    default:
      return "sqrt";
  }
}

class Report {
 public:
  Report(const std::string& words, const Explanation& e, unsigned most)
      : words_(words), e_(e), most_(most), text_(e.config.format) {
    order_.resize(e.operations.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(), [&e](std::size_t x, std::size_t y) {
      return cycle_of(e.operations[x]) < cycle_of(e.operations[y]);
    });
  }

  [[nodiscard]] std::string text() {
    put("{} ({} operations of the reference, {} found on the card)\n", words_, e_.operations.size(),
        e_.found);
    if (!order_.empty()) print_operations();
    put("\ncard       {}\nreference  {}\n", result(e_.card), result(e_.reference));
    if (e_.reference.bad)
      put("Both sides refuse the pair, so its operations explain nothing.\n");
    else
      print_findings();
    return std::move(all_);
  }

  [[nodiscard]] nlohmann::ordered_json differences() const {
    using Json = nlohmann::ordered_json;
    Json all = Json::array();
    for (const Finding& f : e_.findings) {
      Json entry = {{"on_the_card", operation(f.compared, false)},
                    {"comparison", comparison(f.compared)},
                    {"reference", operation(f.compared, true)},
                    {"sources", Json::array()}};
      for (const explain::Source& s : f.sources) {
        Json lines = Json::array();
        for (const netlist::Place& p : s.places)
          lines.push_back({{"file", p.file}, {"line", p.line}, {"instance", p.instance}});
        entry["sources"].push_back(std::move(lines));
      }
      all.push_back(std::move(entry));
    }
    return all;
  }

 private:
  template <class... Args>
  void put(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(all_), format, std::forward<Args>(args)...);
  }

  static unsigned cycle_of(const Compared& c) { return c.seat.which < 0 ? 0 : c.seat.offset; }

  [[nodiscard]] std::string value(std::uint64_t word) const { return text_.decimal_and_bits(word); }
  [[nodiscard]] std::string outcome(FpOp op, std::uint64_t word) const {
    return is_comparison(op) ? word != 0 ? "yes" : "no" : value(word);
  }

  /// The operation as the card or the reference did it.
  [[nodiscard]] std::string operation(const Compared& c, bool reference) const {
    const Step& step = step_of(c);
    const bool card = !reference && c.seat.which >= 0;
    if (!reference && !card) return "not found";
    const FpOp op =
        card ? e_.operators[static_cast<std::size_t>(c.seat.which)].operation : step.operation;
    const std::uint64_t a = card ? c.card.a : step.a, b = card ? c.card.b : step.b,
                        r = card ? c.card.result : step.result;
    if (op == FpOp::kSqrt) return fmt::format("sqrt {} = {}", value(a), outcome(op, r));
    return fmt::format("{} {} {} = {}", value(a), sign_of(op), value(b), outcome(op, r));
  }
  [[nodiscard]] const Step& step_of(const Compared& c) const {
    return e_.recording.steps[static_cast<std::size_t>(e_.recording.operators[c.operation])];
  }

  /// Units in the last place between two words of a format; empty for NaN.
  [[nodiscard]] std::string ulps(const Compared& c) const {
    const Step& step = step_of(c);
    const FpFormat& f = e_.config.format;
    if (is_comparison(step.operation) || f.is_nan(step.result) || f.is_nan(c.card.result))
      return "";
    const auto place = [&f](std::uint64_t w) {
      const auto magnitude = static_cast<std::int64_t>(w & f.magnitude_mask());
      return (w & f.sign_bit()) != 0 ? -magnitude : magnitude;
    };
    const std::int64_t x = place(step.result), y = place(c.card.result);
    const std::uint64_t apart = x > y
                                    ? static_cast<std::uint64_t>(x) - static_cast<std::uint64_t>(y)
                                    : static_cast<std::uint64_t>(y) - static_cast<std::uint64_t>(x);
    return fmt::format("{} ulp apart", apart);
  }

  /// Whether the operands are exchanged. Sums and products have no operand order.
  [[nodiscard]] bool exchanged(const Compared& c) const {
    const Step& step = step_of(c);
    return step.operation != FpOp::kSqrt && c.card.a == step.b && c.card.b == step.a &&
           step.a != step.b;
  }

  [[nodiscard]] const char* comparison(const Compared& c) const {
    switch (c.comparison) {
      case Comparison::kSame:
        return "same";
      case Comparison::kResult:
        return exchanged(c) ? "the operands are exchanged"
                            : "the operands are right, the result is not";
      case Comparison::kOperands:
        return "an operand differs";
      case Comparison::kUnknown:
        return "not known";
      case Comparison::kMissing:
        return "no operator of the card has these operands";
    }
    return "";
  }

  void print_operations() {
    std::size_t line = 4, name = 4;
    for (const explain::Source& s : e_.sources) {
      line = std::max(line, s.line().size());
      name = std::max(name, s.name().size());
    }
    put("\n{:>5}  {:<{}}  {:<{}}  operation\n", "cycle", "line", line, "name", name);
    std::size_t shown = 0, left_out = 0;
    for (const std::size_t i : order_) {
      const Compared& c = e_.operations[i];
      if (c.seat.which < 0) continue;
      if (most_ != 0 && shown >= most_ && !c.first) {
        ++left_out;
        continue;
      }
      ++shown;
      const explain::Source& s = e_.sources[static_cast<std::size_t>(c.seat.which)];
      put("{:>5}  {:<{}}  {:<{}}  {}\n", c.seat.offset, s.line(), line, s.name(), name,
          operation(c, false));
      if (c.comparison != Comparison::kSame)
        put("{:>5}  {:<{}}  {}\n", c.first ? "-->" : "", "reference", line + name + 2,
            operation(c, true));
    }
    if (left_out != 0) put("       {} more (--max)\n", left_out);
  }

  void print_findings() {
    if (e_.same()) {
      put("The card's answer equals the reference's{}.\n",
          e_.findings.empty() ? "" : ", although operations differ");
      if (e_.findings.empty()) return;
    } else if (e_.findings.empty()) {
      put("No operation differs: the error is behind the operators, in a selection or sign before "
          "the outputs of the pipe.\n");
      return;
    }
    constexpr std::size_t kSensible = 20;
    if (e_.findings.size() > kSensible)
      put("{} operations differ although all their inputs are right: this is little evidence.\n",
          e_.findings.size());
    put("\nThe card first differs from the reference in\n");
    std::size_t number = 0;
    for (const Finding& f : e_.findings) {
      if (number == kSensible) {
        put("  {} more\n", e_.findings.size() - number);
        break;
      }
      const std::string apart =
          f.compared.comparison == Comparison::kResult ? ulps(f.compared) : "";
      put("  {}. {}\n", ++number,
          f.sources.empty() ? "an operator without a match" : f.sources[0].text());
      put("     {}{}{}\n", comparison(f.compared), apart.empty() ? "" : ", ", apart);
      if (f.compared.seat.which >= 0) put("     card       {}\n", operation(f.compared, false));
      put("     reference  {}\n", operation(f.compared, true));
      for (std::size_t k = 1; k < std::min<std::size_t>(f.sources.size(), 4); ++k)
        put("     or {}\n", f.sources[k].text());
    }
  }

  [[nodiscard]] std::string result(const PairResult& r) const {
    if (r.bad) return "bad: an operand is out of contract";
    const auto vector = [this](const auto& v) {
      std::string all;
      for (const std::uint64_t word : v) {
        fmt::memory_buffer b;
        text_.append_decimal(b, word);
        if (!all.empty()) all += ',';
        all += fmt::to_string(b);
      }
      return all;
    };
    return fmt::format("F {}, T {}, CP {}, n {}", r.f ? 1 : 0, value(r.t), vector(r.cp),
                       vector(r.n));
  }

  const std::string& words_;
  const Explanation& e_;
  unsigned most_;
  WordText text_;
  std::string all_;
  std::vector<std::size_t> order_;  ///< operations by cycle
};

}  // namespace

std::string explanation_text(const std::string& words, const Explanation& explanation,
                             unsigned most) {
  return Report(words, explanation, most).text();
}

nlohmann::ordered_json explanation_differences(const Explanation& explanation) {
  return Report("", explanation, 0).differences();
}

}  // namespace cde
