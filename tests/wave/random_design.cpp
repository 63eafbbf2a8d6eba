// SPDX-License-Identifier: Apache-2.0
#include "random_design.hpp"

#include <fmt/format.h>

#include <array>
#include <random>
#include <vector>

namespace cde::testing {
namespace {

struct Input {
  std::string name;
  unsigned width;
  bool is_signed;
};

constexpr std::array<unsigned, 10> kWidths = {1, 2, 3, 8, 17, 32, 64, 65, 100, 130};

class Maker {
 public:
  explicit Maker(unsigned seed) : random_(seed) {
    for (const unsigned width : kWidths)
      for (const bool is_signed : {false, true})
        inputs_.push_back({fmt::format("{}{}", is_signed ? 's' : 'u', width), width, is_signed});
  }

  RandomDesign make(unsigned processes, const std::string& file) {
    line("module dut(input clk");
    for (const Input& i : inputs_)
      line(fmt::format("  , input {}[{}:0] {}", i.is_signed ? "signed " : "", i.width - 1, i.name));
    line(");");
    for (unsigned p = 0; p < processes; ++p) process();
    line("endmodule");
    design_.marks = processes;
    write_bench(file);
    return std::move(design_);
  }

 private:
  unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }
  void line(const std::string& text) {
    design_.source += text + '\n';
    ++line_;
  }
  const Input& input() { return inputs_[below(static_cast<unsigned>(inputs_.size()))]; }

  /// Neither the smallest nor the largest three-bit value: Verilator evaluates `u3 >= 0` as true
  /// even if u3 is x.
  std::string literal() {
    return fmt::format("{}'{}d{}", 3 + below(3), below(3) == 0 ? "s" : "", 2 + below(2));
  }
  /// An operand of any width. Small operands are frequent, so that some are equal.
  std::string operand(unsigned depth) {
    switch (depth == 0 ? below(4) : below(16)) {
      case 0:
        return literal();
      case 1:
        return std::to_string(2 + below(4));
      case 2:
      case 3:
        return input().name;
      case 4:
        return part();
      case 5:
        return below(3) != 0 ? fmt::format("({} {} {})", operand(depth - 1), pick({"+", "-"}),
                                           operand(depth - 1))
                             : fmt::format("({} * {})", input().name, input().name);
      case 6:  // never a division by zero, and small: Icarus counts wide quotients
        return fmt::format("({} {} ({} | 1'b1))", pick({"u3", "u8", "u17", "s8", "s17"}),
                           pick({"/", "%"}), pick({"u2", "u8", "s8"}));
      case 7:
        return fmt::format("({} {} {})", operand(depth - 1), pick({"&", "|", "^", "~^"}),
                           operand(depth - 1));
      case 8:
        return fmt::format("({} {} {})", input().name, pick({"<<", ">>", "<<<", ">>>"}),
                           pick({"1", "u3", "u8", "7"}));
      case 9:
        return fmt::format("{}({})", pick({"-", "~", "+"}), operand(depth - 1));
      case 10:
        return fmt::format("{{{}, {}}}", input().name, input().name);
      case 11:
        return fmt::format("{{{}{{{}}}}}", 1 + below(4), input().name);
      case 12:
        return fmt::format("{}({})", pick({"$signed", "$unsigned"}), operand(depth - 1));
      case 13:
        return fmt::format("({} ? {} : {})", condition(depth - 1), operand(depth - 1),
                           operand(depth - 1));
      case 14:
        return fmt::format("({} ** {})", pick({"u8", "s8", "u17"}), 1 + below(3));
      default:
        return fmt::format("({})", condition(depth - 1));
    }
  }
  std::string part() {
    switch (below(4)) {
      case 0:
        return "u8[u3]";
      case 1:
        return "u100[u3 +: 5]";
      case 2:
        return fmt::format("s130[{}:{}]", 70 + below(60), below(70));
      default:
        return fmt::format("u32[{}]", below(32));
    }
  }
  std::string pick(std::initializer_list<const char*> words) {
    return *(words.begin() + below(static_cast<unsigned>(words.size())));
  }
  std::string condition(unsigned depth) {
    switch (depth == 0 ? below(4) : below(12)) {
      case 0:
      case 1:
        return fmt::format("{} {} {}", operand(depth), pick({"<", "<=", ">", ">="}),
                           operand(depth));
      case 2:
        return fmt::format("$signed({}) {} $signed({})", input().name,
                           pick({"<", "<=", ">", ">=", "==", "!="}), operand(depth));
      case 3:
        return fmt::format("{} {} {}", input().name, pick({"==", "!=", "===", "!=="}),
                           operand(depth));
      case 4:
        return fmt::format("{}({})", pick({"&", "|", "^", "~&", "~|", "~^", "!"}),
                           operand(depth - 1));
      case 5:
      case 6:
        return fmt::format("({}) {} ({})", condition(depth - 1), pick({"&&", "||"}),
                           condition(depth - 1));
      case 7:
        return fmt::format("u3 {} 3'b{}{}{}", pick({"===", "!=="}), pick({"0", "1", "x", "z"}),
                           pick({"0", "1", "x", "z"}), pick({"0", "1"}));
      case 8:
        return fmt::format("!({})", condition(depth - 1));
      default:
        return input().name;
    }
  }

  void mark(const std::string& indent, const std::string& assign) {
    design_.lines[next_] = line_ + 1;
    line(fmt::format("{}{} {} 16'd{};", indent, mark_, assign, next_++));
  }
  void statement(unsigned depth, const std::string& indent, const std::string& assign) {
    const unsigned kind = depth == 0 ? 0 : below(8);
    if (kind < 2) {
      mark(indent, assign);
    } else if (kind < 6) {
      line(fmt::format("{}if ({}) begin", indent, condition(2)));
      statement(depth - 1, indent + "  ", assign);
      if (below(3) != 0) {
        line(indent + "end else begin");
        statement(depth - 1, indent + "  ", assign);
      }
      line(indent + "end");
    } else {
      choice(depth, indent, assign);
    }
  }
  /// Verilator extends case items with their own signs, other simulators as the standard requires.
  /// All items here are unsigned.
  void choice(unsigned depth, const std::string& indent, const std::string& assign) {
    const std::string kind = pick({"case", "casez", "casex"});
    const bool narrow = below(2) != 0;
    line(fmt::format(
        "{}{} ({})", indent, kind,
        narrow ? pick({"u3", "u2", "u8[2:0]"}) : fmt::format("$unsigned({})", operand(1))));
    for (unsigned i = 2 + below(3); i > 0; --i) {
      std::string item = "3'b";
      for (unsigned bit = 0; bit < 3; ++bit)
        item += kind == "case" ? pick({"0", "1"}) : pick({"0", "1", "?", "z"});
      if (kind == "casex" && below(2) != 0) item.back() = 'x';
      if (below(4) == 0) item += ", " + pick({"u1", "u3", "u8", "u64", "u130", "2'd2", "3'd6"});
      line(fmt::format("{}  {}: begin", indent, item));
      statement(depth - 1, indent + "    ", assign);
      line(indent + "  end");
    }
    if (below(3) != 0) {
      line(indent + "  default: begin");
      statement(depth - 1, indent + "    ", assign);
      line(indent + "  end");
    }
    line(indent + "endcase");
  }

  void process() {
    const unsigned number = process_++;
    mark_ = fmt::format("m{}", number);
    line(fmt::format("  reg [15:0] {};", mark_));
    if (below(5) == 0) {
      const unsigned yes = next_++, no = next_++;
      line(fmt::format("  wire [15:0] k{0} = 16'd{0}, k{1} = 16'd{1};", yes, no));
      design_.choices[number] = {line_ + 1, yes, no};
      line(fmt::format("  always @* {} = {} ? k{} : k{};", mark_, condition(2), yes, no));
      return;
    }
    const bool clocked = below(2) != 0;
    line(clocked ? "  always @(posedge clk) begin" : "  always @* begin");
    statement(3, "    ", clocked ? "<=" : "=");
    // A later statement of a process overrides earlier ones.
    if (below(3) == 0) statement(2, "    ", clocked ? "<=" : "=");
    line("  end");
  }

  void write_bench(const std::string& file) {
    std::string& b = design_.bench;
    b = "`timescale 1ns/1ns\nmodule bench;\n  reg clk = 0;\n";
    std::string ports = ".clk(clk)", values;
    for (const Input& i : inputs_) {
      b += fmt::format("  reg {}[{}:0] {};\n", i.is_signed ? "signed " : "", i.width - 1, i.name);
      ports += fmt::format(", .{0}({0})", i.name);
    }
    b += fmt::format("  dut dut({});\n  initial begin\n    $dumpfile(\"{}\");\n    $dumpvars;\n",
                     ports, file);
    for (unsigned turn = 0; turn < 24; ++turn) {
      for (const Input& i : inputs_) {
        std::string digits;
        const unsigned few = below(3);  // leading zeros, random bits, or leading ones
        const unsigned unknown = turn % 3 == 2 && i.width > 2 ? 1 + below(4) : 0;
        for (unsigned bit = i.width; bit-- > 0;) {
          const char random = below(2) != 0 ? '1' : '0';
          digits.push_back(few == 0 && bit > 2 ? '0' : few == 1 && bit > 2 ? '1' : random);
          if (unknown != 0 && below(3 * unknown) == 0) digits.back() = below(3) != 0 ? 'x' : 'z';
        }
        b += fmt::format("    {} = {}'b{};\n", i.name, i.width, digits);
      }
      b += "    #5 clk = 1;\n    #5 clk = 0;\n";
    }
    b += "    #1 $finish;\n  end\nendmodule\n";
  }

  std::mt19937 random_;
  std::vector<Input> inputs_;
  RandomDesign design_;
  std::string mark_;
  unsigned line_ = 0, next_ = 1, process_ = 0;
};

}  // namespace

RandomDesign random_design(unsigned seed, unsigned processes, const std::string& file) {
  return Maker(seed).make(processes, file);
}

}  // namespace cde::testing
