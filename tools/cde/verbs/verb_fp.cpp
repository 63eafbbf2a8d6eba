// SPDX-License-Identifier: Apache-2.0
// cde fp: runs operands from stdin through the simulated floating-point units, in the line format
// of Berkeley TestFloat.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/card/fp_unit.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "options/line_input.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {
namespace {

struct Request {
  FpOp op = FpOp::kAdd;
  std::optional<FpFormat> format;  // set by a TestFloat name
  bool exact = true;               // raises inexact; a TestFloat name with `_r_` sets false
};

std::optional<FpOp> op_by_name(const std::string& name) {
  const auto at = std::find(kFpOpNames.begin(), kFpOpNames.end(), name);
  if (at == kFpOpNames.end()) return std::nullopt;
  return static_cast<FpOp>(at - kFpOpNames.begin());
}

std::optional<FpFormat> format_by_name(const std::string& name) {
  try {
    return FpFormat::parse(name);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Makes "f16" and "fp16" the same in the names of conversions.
std::string canonical(std::string name) {
  for (const char* bits : {"16", "32", "64"})
    if (name == fmt::format("to_f{}", bits)) name = fmt::format("to_fp{}", bits);
  return name;
}

/// Removes TestFloat's rounding from the name of a conversion to integer; "minMag" is truncation.
/// With "_rx_" the conversion raises inexact, with "_r_" it does not.
std::string without_rounding(std::string name, bool& exact) {
  struct Suffix {
    std::string_view testfloat, here;
    bool exact;
  };
  if (!name.starts_with("to_i") && !name.starts_with("to_ui")) return name;
  for (const Suffix& s :
       {Suffix{"_rx_near_even", "", true}, Suffix{"_r_near_even", "", false},
        Suffix{"_rx_minmag", "_trunc", true}, Suffix{"_r_minmag", "_trunc", false}}) {
    if (!name.ends_with(s.testfloat)) continue;
    exact = s.exact;
    name.resize(name.size() - s.testfloat.size());
    return name.append(s.here);
  }
  return name;
}

/// Parses the name of an operation, or a TestFloat name: f32_add, f32_to_f16, f32_to_i32,
/// i32_to_f32.
Request parse_request(const std::string& text) {
  std::string name = text;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  name = canonical(name);
  if (const auto op = op_by_name(name)) return {*op, std::nullopt};
  if (const auto bar = name.find('_'); bar != std::string::npos) {
    const std::string head = name.substr(0, bar), tail = name.substr(bar + 1);
    if (const auto format = format_by_name(head)) {
      bool exact = true;
      const auto op = op_by_name(canonical(without_rounding(tail, exact)));
      if (op) return {*op, format, exact};
    } else if (tail.starts_with("to_")) {
      const auto op = op_by_name("from_" + head);
      const auto format_to = format_by_name(tail.substr(3));
      if (op && format_to) return {*op, format_to};
    }
  }
  throw Error(ErrorCode::kUsage,
              fmt::format("operation {}: not one of {}, nor a TestFloat name such as f32_add",
                          in_quotes(text), fmt::join(kFpOpNames, " ")));
}

/// Bits of an integer operand or result of the operation; 0 for a number of the format.
int integer_operand_bits(FpOp op) {
  if (op < FpOp::kFromI32 || op > FpOp::kFromUi64) return 0;
  return op <= FpOp::kFromUi32 ? 32 : 64;
}
int result_digits(FpOp op, FpFormat format) {
  if (op >= FpOp::kLt && op <= FpOp::kEq) return 1;
  if (op >= FpOp::kToI32)
    return (static_cast<unsigned>(op) - static_cast<unsigned>(FpOp::kToI32)) % 4 < 2 ? 8 : 16;
  if (op >= FpOp::kToFp16 && op < FpOp::kFromI32)
    return kFpFormats.at(static_cast<std::size_t>(op) - static_cast<std::size_t>(FpOp::kToFp16))
        .format.hex_digits();
  return format.hex_digits();
}

/// Reads operand lines, a batch at a time, and prints `operands result flags`.
class Stream {
 public:
  Stream(FpOp op, bool exact, FpFormat format, FpUnit& unit)
      : op_(op),
        unit_(unit),
        flags_shown_(exact ? 0xff : static_cast<uint8_t>(~kFpInexact)),
        operands_(fp_operands(op)),
        bits_(integer_operand_bits(op) != 0 ? integer_operand_bits(op) : format.width()),
        operand_digits_((bits_ + 3) / 4),
        result_digits_(result_digits(op, format)) {
    digit_.fill(-1);
    for (int d = 0; d < 16; d++) {
      digit_[static_cast<unsigned char>("0123456789abcdef"[d])] = d;
      digit_[static_cast<unsigned char>("0123456789ABCDEF"[d])] = d;
    }
  }

  /// Answers all lines of a read before the next read, and before the error of a bad line.
  void run() {
    LineInput input;
    const auto take = [this](std::uint64_t number, std::string_view text) {
      line_ = number;
      line(text.data(), text.data() + text.size());
      if (a_.size() == kBatch) flush();
    };
    try {
      while (input.next(take)) flush();
    } catch (const StdoutError&) {
      throw;
    } catch (const Error&) {
      flush();
      throw;
    }
    flush();
  }

 private:
  static constexpr std::size_t kBatch = 65536;  // most operations per run of the unit

  [[noreturn]] void malformed(const char* at, const char* stop, const std::string& why) const {
    const std::string_view text(at, static_cast<std::size_t>(stop - at));
    throw Error(ErrorCode::kBadInput,
                fmt::format("stdin line {}: {}: {}", line_, why, in_quotes(text)));
  }

  void line(const char* at, const char* stop) {
    const char* const begin = at;
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    std::array<uint64_t, 2> value{};
    for (int i = 0; i < operands_; i++) {
      while (at < stop && blank(*at)) at++;
      if (at == stop && i == 0) return;  // an empty line
      const char* const first = at;
      uint64_t v = 0;
      while (at < stop && !blank(*at)) {
        const int d = digit_[static_cast<unsigned char>(*at)];
        if (d < 0) malformed(begin, stop, fmt::format("operand {} is not hexadecimal", i + 1));
        v = (v << 4) | static_cast<uint64_t>(d);
        at++;
      }
      if (at == first)
        malformed(begin, stop, fmt::format("{} operands wanted, {} found", operands_, i));
      if (at - first > operand_digits_ || (bits_ < 64 && (v >> bits_) != 0))
        malformed(begin, stop, fmt::format("operand {} has more than {} bits", i + 1, bits_));
      value.at(static_cast<std::size_t>(i)) = v;
    }
    a_.push_back(value[0]);
    if (operands_ == 2) b_.push_back(value[1]);
  }

  char* hex(char* to, uint64_t v, int digits) const {
    for (int i = digits - 1; i >= 0; i--) *to++ = "0123456789ABCDEF"[(v >> (4 * i)) & 15];
    return to;
  }

  void flush() {
    if (a_.empty()) return;
    r_.resize(a_.size());
    flags_.resize(a_.size());
    unit_.apply(op_, a_, b_, r_, flags_);
    constexpr std::size_t kLongest = 3 * 17 + 3;
    text_.resize(a_.size() * kLongest);
    char* to = text_.data();
    for (std::size_t i = 0; i < a_.size(); i++) {
      to = hex(to, a_[i], operand_digits_);
      *to++ = ' ';
      if (operands_ == 2) {
        to = hex(to, b_[i], operand_digits_);
        *to++ = ' ';
      }
      to = hex(to, r_[i], result_digits_);
      *to++ = ' ';
      to = hex(to, flags_[i] & flags_shown_, 2);
      *to++ = '\n';
    }
    const auto size = static_cast<std::size_t>(to - text_.data());
    a_.clear();
    b_.clear();
    stdout_.write({text_.data(), size});
    stdout_.flush();
  }

  FpOp op_;
  FpUnit& unit_;
  uint8_t flags_shown_;
  int operands_, bits_, operand_digits_, result_digits_;
  std::array<int, 256> digit_{};
  uint64_t line_ = 0;
  std::vector<uint64_t> a_, b_, r_;
  std::vector<uint8_t> flags_;
  std::vector<char> text_;
  OutputFile stdout_{"-"};
};

struct Options {
  std::string op, format, arith = "rtl";
  int lanes = 8;  // enough for text input, and built quickly
};

void run(const Options& options) {
  const Request request = parse_request(options.op);
  FpFormat format = request.format.value_or(FpFormat{});
  if (!options.format.empty()) {
    format = FpFormat::parse(options.format);
    if (request.format && *request.format != format)
      cannot_combine("--format " + format.name(), options.op);
  }
  FpUnit unit(format, options.arith == "rtl" ? Arithmetic::kRtl : Arithmetic::kHost, options.lanes);
  Stream(request.op, request.exact, format, unit).run();
}

}  // namespace

void add_fp(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "fp",
      "Run floating-point operands through simulated hardware. Reads hexadecimal operands from "
      "stdin, one operation per line, and prints `operands result flags` as Berkeley TestFloat "
      "does (flags: 01 inexact, 02 underflow, 04 overflow, 08 divide by zero, 10 invalid). Ignores "
      "further fields, so it also reads the output of testfloat_gen. Conversions to integers raise "
      "inexact, as testfloat_gen and testfloat_ver expect with -exact; names with _r_near_even or "
      "_r_minMag do not. Answers all lines that it has read before it waits for more. A line that "
      "cannot be read ends it, after the answers to earlier lines");
  text_value(
      verb->add_option(
              "op", options->op,
              "add sub mul div sqrt lt le eq min max, to_FORMAT, to_INT[_trunc] and from_INT with "
              "INT "
              "one of i32 ui32 i64 ui64, "
              "or a TestFloat name (f32_add, f32_to_i32, f32_to_i32_rx_minMag, i32_to_f32), which "
              "implies the format")
          ->required(),
      "OP", [](const std::string& text) { (void)parse_request(text); });
  std::vector<std::string_view> formats;
  for (const NamedFpFormat& f : kFpFormats) formats.push_back(f.name);
  text_value(verb->add_option("-f,--format", options->format,
                              fmt::format("{}, or eEmM", fmt::join(formats, " ")))
                 ->default_str("fp32"),
             "FORMAT", [](const std::string& text) { (void)FpFormat::parse(text); });
  one_of(verb->add_option("-a,--arith", options->arith,
                          "rtl: the gates; host: the host's FPU, same bits")
             ->capture_default_str(),
         {"rtl", "host"});
  quiet_flag(*verb);
  whole_number_in(verb->add_option("-l,--lanes", options->lanes, "Lanes of the simulated unit")
                      ->capture_default_str(),
                  1, 256, "");
  verb->callback([options] { run(*options); });
}

}  // namespace cde::cli
