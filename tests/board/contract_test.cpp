// SPDX-License-Identifier: Apache-2.0
// rtl/contract and host/include/cde/contract agree. Verilator evaluates every constant, field and
// function of the packages. Each must have a counterpart in C++, and C++ has no others.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "cde/contract/formats.hpp"
#include "cde/contract/pairs.hpp"
#include "cde/contract/pci.hpp"
#include "cde/contract/records.hpp"
#include "cde/contract/registers.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/length_range.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/reference/pipes/scale.hpp"
#include "contract_values.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;
using namespace contract_values;

/// Enumeration types and their widths in bits.
const std::map<std::string, unsigned> kCodes = {
    {"shape_t", kShapeBits}, {"pair_t", kPairBits}, {"words_t", kWordsBits}};

struct Package {
  std::set<std::string> constants, functions;
  Fields fields;
  std::map<std::string, unsigned> bits;  ///< width of each structure
  std::set<std::string> codes;           ///< types that are plain vectors
};

Package read_package(const fs::path& file) {
  std::ifstream in(file);
  static const std::regex constant(R"(^\s*localparam\s+(?:\w+\s+)+?(?:\[[^\]]*\]\s*)?(\w+)\s*=.*)");
  static const std::regex function(R"(^\s*function automatic .*?(\w+)\(.*)");
  static const std::regex field(R"(^\s*logic\s+(?:\[(\d+):0\]\s+)?(\w+);.*)");
  static const std::regex code(R"(^\s*typedef logic \[\d+:0\] (\w+);.*)");
  static const std::regex code_field(R"(^\s*pairs_pkg::(\w+)\s+(\w+);.*)");
  static const std::regex end(R"(^\s*\}\s*(\w+);.*)");
  Package package;
  std::vector<std::pair<std::string, unsigned>> open;  // enclosing fields, outermost first
  for (std::string line; std::getline(in, line);) {
    std::smatch m;
    if (std::regex_match(line, m, constant)) {
      package.constants.insert(m[1]);
    } else if (line.find("localparam") != std::string::npos) {
      ADD_FAILURE() << file << ": cannot parse line: " << line;
    } else if (std::regex_match(line, m, function)) {
      package.functions.insert(m[1]);
    } else if (line.find("typedef struct packed") != std::string::npos) {
      open.clear();
    } else if (std::regex_match(line, m, code)) {
      package.codes.insert(m[1]);
    } else if (std::regex_match(line, m, code_field)) {
      open.emplace_back(m[2], kCodes.at(m[1]));
    } else if (std::regex_match(line, m, field)) {
      open.emplace_back(m[2], m[1].matched ? static_cast<unsigned>(std::stoul(m[1])) + 1 : 1);
    } else if (std::regex_match(line, m, end)) {
      unsigned low = 0;
      for (auto f = open.rbegin(); f != open.rend(); low += f->second, ++f)
        if (f->first.rfind("reserved", 0) != 0)
          package.fields[m[1].str() + "." + f->first] = {low, f->second};
      package.bits[m[1]] = low;
    } else if (line.find("typedef") != std::string::npos) {
      ADD_FAILURE() << file << ": cannot parse line: " << line;
    }
  }
  return package;
}

/// Expressions of SystemVerilog and their expected values. Verilator evaluates all of them at once.
class Probe {
 public:
  void expect(const std::string& expression, std::uint64_t value) {
    expected_.emplace_back(expression, value);
  }
  void run(const fs::path& contract, const std::vector<std::string>& packages) const {
    std::string folder = (fs::temp_directory_path() / "cde-contract-XXXXXX").string();
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    const fs::path work(folder);
    std::ofstream out(work / "contract_probe.sv");
    out << "module contract_probe;\n";
    for (std::size_t i = 0; i < expected_.size(); ++i)
      out << "  $info(\"@" << i << " %0h\", 64'(" << expected_[i].first << "));\n";
    out << "endmodule\n";
    out.close();
    std::string command =
        "cd '" + folder + "' && verilator --lint-only -Wno-fatal -I'" + contract.string() + "'";
    for (const std::string& package : packages)
      command += " '" + (contract / package).string() + "'";
    command += " contract_probe.sv >said 2>&1";
    const int status = std::system(command.c_str());
    std::stringstream said;
    said << std::ifstream(work / "said").rdbuf();
    fs::remove_all(work);
    ASSERT_EQ(status, 0) << said.str();
    std::set<std::size_t> seen;
    static const std::regex form(R"(.*: @(\d+) ([0-9a-f]+)$)");
    for (std::string line; std::getline(said, line);) {
      std::smatch m;
      if (!std::regex_match(line, m, form)) continue;
      const auto& [expression, value] = expected_.at(std::stoul(m[1]));
      EXPECT_EQ(std::stoull(m[2], nullptr, 16), value) << expression;
      seen.insert(std::stoul(m[1]));
    }
    EXPECT_EQ(seen.size(), expected_.size()) << "Verilator did not print all values";
  }

 private:
  std::vector<std::pair<std::string, std::uint64_t>> expected_;
};

/// Calls of one function. The test checks which functions were called.
class Calls {
 public:
  Calls(Probe& probe, std::string package) : probe_(probe), package_(std::move(package)) {}
  void operator()(const std::string& function, const std::vector<int>& arguments, auto value) {
    std::string call = package_ + "::" + function + "(";
    for (const int& a : arguments)
      call.append(arguments.data() == &a ? "" : ", ").append(std::to_string(a));
    probe_.expect(call + ")", static_cast<std::uint64_t>(static_cast<std::int64_t>(value)));
    called_.insert(function);
  }
  [[nodiscard]] const std::set<std::string>& called() const { return called_; }

 private:
  Probe& probe_;
  std::string package_;
  std::set<std::string> called_;
};

/// Words of a lane of gates. Software does not use them.
void lane_functions(Calls& call, int exp, int man) {
  const int word = 1 + exp + man <= 32 && man <= 23 ? 32 : 64;
  int bits = 1;  // width of the largest exponent of a quotient, with its sign
  while ((1 << (bits - 1)) < 3 * (1 << (exp - 1)) + 2 * man + 4) ++bits;
  call("lane_word", {exp, man, 0}, word);
  call("lane_word", {exp, man, 1}, man + std::max(1 + exp, 6));
  call("lane_exponent", {exp, man, 0}, word);
  call("lane_exponent", {exp, man, 1}, bits);
  call("round_top", {exp, man, 0}, word - 1);
  call("round_top", {exp, man, 1}, man + 3);
}

/// Register cuts, spread over the places of a lane: the first k places get the nearest share of
/// cuts.
void cut_functions(Calls& call) {
  for (const int places : {1, 8, 31})
    for (const int cuts : {0, 1, places / 2, places}) {
      int before = 0;
      for (int place = 0; place < places; ++place) {
        const int share = ((place + 1) * cuts + places / 2) / places;
        call("cuts_at", {cuts, places, place}, share - before);
        before = share;
      }
    }
}

void format_functions(Calls& call) {
  cut_functions(call);
  for (std::size_t k = 0; k < kFpFormats.size(); ++k) {
    call("format_exp", {static_cast<int>(k)}, kFpFormats.at(k).format.exp_bits);
    call("format_man", {static_cast<int>(k)}, kFpFormats.at(k).format.man_bits);
  }
  for (int exp = 3; exp <= 11; ++exp) {
    call("length_high", {exp}, LengthRange::of(exp, 2).high);
    for (const int man : {2, 3, 7, 10, 16, 20, 23, 24, 52}) {
      const FpFormat format{exp, man};
      lane_functions(call, exp, man);
      call("container", {exp, man}, contract::container(exp, man));
      call("infinity", {exp, man}, format.infinity());
      call("quiet_nan", {exp, man}, format.canonical_nan());
      call("sign_bit", {exp, man}, format.sign_bit());
      call("length_low", {exp, man}, LengthRange::of(exp, man).low);
      for (const int e : {-40, -3, -1, 0, 1, 2})
        if (e <= format.bias())
          call("power_of_two", {exp, man, e},
               e < format.emin() - man ? 0 : format.encode(std::ldexp(1.0, e)));
    }
  }
  call("larger", {3, 4}, 4);
  call("larger", {4, -3}, 4);
}

void shape_functions(Calls& call) {
  for (int s = 0; s < static_cast<int>(kShapes); ++s) {
    const auto shape = static_cast<Shape>(s);
    int lengths = 0;
    call("shape_words", {s}, words(shape));
    for (int k = 0; k < static_cast<int>(contract::kMostWords); ++k) {
      const WordKind kind = contract::word_kind(shape, static_cast<std::size_t>(k));
      call("word_kind", {s, k}, kind);
      call("is_length", {s, k}, reference::scaling::is_length(kind));
      if (reference::scaling::is_length(kind)) call("length_word", {s, lengths++}, k);
    }
    call("lengths", {s}, lengths);
  }
}

void pair_functions(Calls& call) {
  for (int p = 0; p < static_cast<int>(kPairs); ++p) {
    const auto pair = static_cast<Pair>(p);
    const Shape a = primary_shape(pair), b = secondary_shape(pair);
    call("primary_shape", {p}, a);
    call("secondary_shape", {p}, b);
    call("primary_words", {p}, words(a));
    call("secondary_words", {p}, words(b));
    if (has_iterations(pair))
      call("cylinder_body", {p}, a == Shape::kCylinder ? 0 : a == Shape::kObb ? 1 : 2);
    for (const int exp : {3, 7, 8, 11}) call("scaled", {p, exp}, reference::is_scaled(a, b, exp));
  }
}

/// Sets of one pair, of two pairs and of all pairs.
void set_functions(Calls& call) {
  const auto shapes_of = [](int set, bool primary, bool swap) {
    std::set<Shape> shapes;
    for (unsigned p = 0; p < kPairs; ++p) {
      if ((set >> p & 1) == 0) continue;
      if (primary || swap) shapes.insert(primary_shape(static_cast<Pair>(p)));
      if (!primary || swap) shapes.insert(secondary_shape(static_cast<Pair>(p)));
    }
    return shapes;
  };
  std::vector<int> sets = {(1 << kPairs) - 1};
  for (unsigned p = 0; p < kPairs; ++p) sets.insert(sets.end(), {1 << p, 1 << p | 16});
  for (const int set : sets) {
    for (int p = 0; p < static_cast<int>(kPairCodes); ++p)
      call("has", {set, p}, std::int64_t{set} >> p & 1);
    for (const int swap : {0, 1}) {
      for (const int primary : {0, 1}) {
        const std::set<Shape> shapes = shapes_of(set, primary != 0, swap != 0);
        unsigned most = 0;
        for (const Shape shape : shapes) most = std::max(most, words(shape));
        call("slot_words", {set, primary, swap}, most);
        for (int s = 0; s < static_cast<int>(kShapes); ++s)
          call("uses_shape", {set, s, primary, swap}, shapes.contains(static_cast<Shape>(s)));
      }
      for (const unsigned transform : {kTransformSecondaries, kTransformBoth}) {
        const auto t = static_cast<int>(transform);
        std::set<Shape> moved = shapes_of(set, false, swap != 0);
        if (transform == kTransformBoth) moved.merge(shapes_of(set, true, swap != 0));
        for (int s = 0; s < static_cast<int>(kShapes); ++s)
          call("moves_shape", {set, s, swap, t}, moved.contains(static_cast<Shape>(s)));
        call("transform_latency", {set, swap, t, 3, 5}, moved.contains(Shape::kPlane) ? 25 : 14);
      }
    }
  }
}

/// Cycles before and after a scaled pipe; tests/pipes measures them.
void time_functions(Calls& call) {
  for (const int mul : {1, 2, 5})
    for (const int compare : {1, 2, 3}) {
      call("unscale_latency", {0, mul, compare}, compare);
      call("unscale_latency", {1, mul, compare}, std::max(mul, compare));
      call("scale_latency", {0, mul, compare}, 2 * compare);
      call("scale_latency", {1, mul, compare}, compare + std::max(mul, compare));
      call("iterative_entry", {4, mul, compare}, 2 * compare + std::max(4, mul));
    }
}

TEST(Contract, Packages_EqualCppConstants) {
  ASSERT_EQ(std::system("command -v verilator >/dev/null"), 0)
      << "needs verilator, to evaluate the packages";
  const fs::path contract(CDE_CONTRACT_FOLDER);
  std::vector<std::string> packages;
  std::ifstream list(contract / "packages.f");
  for (std::string line; std::getline(list, line);) packages.push_back(line);
  const std::map<std::string, Values> here = {{"formats_pkg", formats()},
                                              {"pairs_pkg", pairs()},
                                              {"records_pkg", records()},
                                              {"registers_pkg", registers()},
                                              {"pci_pkg", pci_side()}};
  // Tables that functions of the packages read.
  const std::map<std::string, std::string> tables = {{"FORMAT_EXPS", "format_exp"},
                                                     {"FORMAT_MANS", "format_man"},
                                                     {"SHAPE_WORDS", "shape_words"},
                                                     {"WORD_KINDS", "word_kind"},
                                                     {"PRIMARY_SHAPES", "primary_shape"},
                                                     {"SECONDARY_SHAPES", "secondary_shape"},
                                                     {"COUNTER_REGISTERS", "counter_register"}};
  // Types between modules of the card that software does not see.
  const std::set<std::string> inside = {"bus_request_t", "bus_response_t"};
  Probe probe;
  Fields known = fields();
  std::size_t constants = 0;
  for (const std::string& file : packages) {
    const std::string name = file.substr(0, file.find('.'));
    if (!here.contains(name)) continue;  // internal connections of the card
    SCOPED_TRACE(file);
    const Package package = read_package(contract / file);
    Calls call(probe, name);
    if (name == "formats_pkg") format_functions(call);
    if (name == "pairs_pkg") {
      shape_functions(call), pair_functions(call), set_functions(call), time_functions(call);
    }
    if (name == "registers_pkg")
      for (int c = 0; c < static_cast<int>(card::kCounters); ++c)
        call("counter_register", {c}, card::kCounterRegisters[c]);
    EXPECT_EQ(call.called(), package.functions);
    Values values = here.at(name);
    for (const std::string& constant : package.constants) {
      if (const auto table = tables.find(constant); table != tables.end()) {
        EXPECT_TRUE(call.called().contains(table->second)) << constant;
        continue;
      }
      EXPECT_TRUE(values.contains(constant))
          << constant << " is missing in C++ or in the lists of this test";
      probe.expect(name + "::" + constant, values[constant]);
      values.erase(constant);
      ++constants;
    }
    for (const auto& [constant, value] : values)
      ADD_FAILURE() << constant << " = " << value << " is not in the package";
    for (const std::string& type : package.codes)
      probe.expect("$bits(" + name + "::" + type + ")", kCodes.at(type));
    for (const auto& [type, bits] : package.bits)
      probe.expect("$bits(" + name + "::" + type + ")", bits);
    for (const auto& [field, place] : package.fields) {
      if (inside.contains(field.substr(0, field.find('.')))) continue;
      EXPECT_TRUE(known.contains(field))
          << field << " is missing in C++ or in the list of this test";
      EXPECT_EQ(known[field], place) << field;
      known.erase(field);
    }
  }
  for (const auto& [field, place] : known) ADD_FAILURE() << field << " is not in the packages";
  EXPECT_GT(constants, 200u);
  probe.run(contract, packages);
}

/// One file lists each parameter three times: as a parameter, as a field and in the assignment that
/// joins them.
TEST(Contract, EveryCardParameter_IsAConfigField) {
  std::stringstream text;
  text << std::ifstream(fs::path(CDE_CONTRACT_FOLDER) / "config.svh").rdbuf();
  const std::string all = text.str();
  const auto names = [&](const char* macro, const char* end, const char* form) {
    const std::size_t from = all.find(std::string("`define ") + macro);
    const std::string part = all.substr(from, all.find(end, from) - from);
    std::vector<std::string> found;
    const std::regex expression(form);
    for (std::sregex_iterator m(part.begin(), part.end(), expression), none; m != none; ++m)
      found.push_back(upper((*m)[1].str()));
    return found;
  };
  auto parameters = names("CARD_PARAMETERS", "\n\n", R"(parameter (?:int )?(\w+) =)");
  auto values = names("CARD_CONFIG", "}", R"((?:[{ (])([A-Z][A-Z_]+)(?=[,} ]|$))");
  auto fields =
      names("CARD_FIELDS", "`endif", R"((?:int|logic \[63:0\]|latency_pkg::latency_t) (\w+);)");
  ASSERT_GT(parameters.size(), 20u);
  values.erase(values.begin());  // drop the name of the macro
  parameters.emplace_back("CONFIG_HASH");
  EXPECT_EQ(values, parameters);
  std::replace(parameters.begin(), parameters.end(), std::string("ARITH"), std::string("HOST"));
  // The latencies of operators are one field of type latency_t, in the same order.
  const auto first = std::find(parameters.begin(), parameters.end(), "LAT_ADD");
  ASSERT_GT(parameters.end() - first, 5);
  EXPECT_EQ(std::vector<std::string>(first, first + 5),
            (std::vector<std::string>{"LAT_ADD", "LAT_MUL", "LAT_DIV", "LAT_SQRT", "LAT_CMP"}));
  *first = "LAT";
  parameters.erase(first + 1, first + 5);
  EXPECT_EQ(fields, parameters);
}

}  // namespace
}  // namespace cde
