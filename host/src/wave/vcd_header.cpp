// SPDX-License-Identifier: Apache-2.0
#include "wave/vcd_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <tuple>
#include <utility>

#include "cde/support/message.hpp"
#include "cde/wave/fst_api.hpp"

namespace cde::wave {
namespace {

constexpr std::string_view kEndWord = "$end";
/// A $var takes about 30 bytes, so this allows 2000 bits for each.
constexpr std::uint64_t kBitsPerByte = 64;
constexpr unsigned kMostOfIdentifier = 8;                    ///< signals of different width or type
constexpr std::size_t kMostSection = std::size_t{64} << 20;  ///< bytes

constexpr std::array<std::pair<std::string_view, int>, 34> kVariableTypes = {{
    {"event", FST_VT_VCD_EVENT},
    {"integer", FST_VT_VCD_INTEGER},
    {"parameter", FST_VT_VCD_PARAMETER},
    {"real", FST_VT_VCD_REAL},
    {"real_parameter", FST_VT_VCD_REAL_PARAMETER},
    {"realtime", FST_VT_VCD_REALTIME},
    {"reg", FST_VT_VCD_REG},
    {"supply0", FST_VT_VCD_SUPPLY0},
    {"supply1", FST_VT_VCD_SUPPLY1},
    {"time", FST_VT_VCD_TIME},
    {"tri", FST_VT_VCD_TRI},
    {"triand", FST_VT_VCD_TRIAND},
    {"trior", FST_VT_VCD_TRIOR},
    {"trireg", FST_VT_VCD_TRIREG},
    {"tri0", FST_VT_VCD_TRI0},
    {"tri1", FST_VT_VCD_TRI1},
    {"wand", FST_VT_VCD_WAND},
    {"wire", FST_VT_VCD_WIRE},
    {"wor", FST_VT_VCD_WOR},
    {"port", FST_VT_VCD_PORT},
    {"sparray", FST_VT_VCD_SPARRAY},
    {"string", FST_VT_GEN_STRING},
    {"bit", FST_VT_SV_BIT},
    {"logic", FST_VT_SV_LOGIC},
    {"int", FST_VT_SV_INT},
    {"shortint", FST_VT_SV_SHORTINT},
    {"longint", FST_VT_SV_LONGINT},
    {"byte", FST_VT_SV_BYTE},
    {"enum", FST_VT_SV_ENUM},
    {"shortreal", FST_VT_SV_SHORTREAL},
    {"in", FST_VT_VCD_WIRE},
    {"out", FST_VT_VCD_WIRE},
    {"inout", FST_VT_VCD_WIRE},
    {"array", FST_VT_VCD_SPARRAY},
}};

constexpr std::array<std::pair<std::string_view, int>, 22> kScopeTypes = {{
    {"module", FST_ST_VCD_MODULE},
    {"task", FST_ST_VCD_TASK},
    {"function", FST_ST_VCD_FUNCTION},
    {"begin", FST_ST_VCD_BEGIN},
    {"fork", FST_ST_VCD_FORK},
    {"generate", FST_ST_VCD_GENERATE},
    {"struct", FST_ST_VCD_STRUCT},
    {"union", FST_ST_VCD_UNION},
    {"class", FST_ST_VCD_CLASS},
    {"interface", FST_ST_VCD_INTERFACE},
    {"package", FST_ST_VCD_PACKAGE},
    {"program", FST_ST_VCD_PROGRAM},
    {"vhdl_architecture", FST_ST_VHDL_ARCHITECTURE},
    {"vhdl_procedure", FST_ST_VHDL_PROCEDURE},
    {"vhdl_function", FST_ST_VHDL_FUNCTION},
    {"vhdl_record", FST_ST_VHDL_RECORD},
    {"vhdl_process", FST_ST_VHDL_PROCESS},
    {"vhdl_block", FST_ST_VHDL_BLOCK},
    {"vhdl_for_generate", FST_ST_VHDL_FOR_GENERATE},
    {"vhdl_if_generate", FST_ST_VHDL_IF_GENERATE},
    {"vhdl_generate", FST_ST_VHDL_GENERATE},
    {"vhdl_package", FST_ST_VHDL_PACKAGE},
}};

template <class Table>
int type_in(const Table& table, std::string_view word, int other) {
  std::string lower(word);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const auto& [name, type] : table)
    if (name == lower) return type;
  return other;
}

template <class Number>
bool read_whole(std::string_view text, Number& to) {
  const char* const stop = text.data() + text.size();
  const auto read = std::from_chars(text.data(), stop, to);
  return read.ec == std::errc() && read.ptr == stop && !text.empty();
}

/// Reads "1ns" or "10 ps".
void read_scale(const WordReader& words, const std::vector<std::string>& section, VcdHeader& to) {
  std::string text;
  for (const std::string& w : section) text += w;
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  constexpr std::array<std::pair<std::string_view, int>, 8> kUnits = {{{"s", 0},
                                                                       {"ms", -3},
                                                                       {"us", -6},
                                                                       {"ns", -9},
                                                                       {"ps", -12},
                                                                       {"fs", -15},
                                                                       {"as", -18},
                                                                       {"zs", -21}}};
  const int unit = type_in(kUnits, text.substr(digits), 1);
  std::uint32_t number = 1;
  if (unit == 1 || (digits != 0 && !read_whole(std::string_view(text).substr(0, digits), number)) ||
      number == 0)
    words.fail(fmt::format("$timescale {}; expected 1, 10 or 100 and s, ms, us, ns, ps or fs",
                           in_quotes(text)));
  for (to.scale = unit; number % 10 == 0; number /= 10) ++to.scale;
  to.factor = number;
}

class HeaderReader {
 public:
  explicit HeaderReader(WordReader& words) : words_(words) {}

  VcdHeader read() {
    std::string_view word;
    while (words_.next(word)) {
      if (word.starts_with("\xef\xbb\xbf")) word.remove_prefix(3);
      if (word.empty()) continue;
      std::string name(word);
      // Some writers omit $enddefinitions.
      if (!h_.identifiers.empty() && (name[0] == '#' || name.starts_with("$dump"))) {
        words_.again();
        return finish();
      }
      if (name[0] != '$')
        words_.fail(
            fmt::format("{} in the header; expected $scope, $var, $enddefinitions or "
                        "another such word",
                        in_quotes(name)));
      if (name == kEndWord) continue;  // a superfluous one
      if (name == "$enddefinitions" || name == "$enddefinitions$end") {
        optional_end();
        return finish();
      }
      if (name == "$upscope" || name == "$upscope$end") {
        optional_end();
        take("$upscope", {});
      } else {
        take(name, vcd_section(words_, name));
      }
    }
    words_.fail("the file ends in its header, before $enddefinitions");
  }

 private:
  void optional_end() {
    std::string_view word;
    if (words_.next(word) && word != kEndWord) words_.again();
  }

  VcdHeader finish() {
    if (h_.identifiers.empty()) words_.fail("the header has no signals ($var)");
    for (; open_ > 0; --open_) h_.names.emplace_back(ScopeEnd());
    return std::move(h_);
  }

  void take(const std::string& name, const std::vector<std::string>& section) {
    if (name == "$var") {
      variable(section);
    } else if (name == "$scope") {
      if (section.empty()) words_.fail("$scope without a name; expected its type and name");
      ScopeName s;
      // A lone word is the type of a nameless scope, or a name.
      const int type = type_in(kScopeTypes, section[0], -1);
      s.type = type < 0 ? FST_ST_VCD_MODULE : type;
      s.name = utf8_text(joined(section, section.size() == 1 && type < 0 ? 0 : 1));
      h_.names.emplace_back(std::move(s));
      ++open_;
    } else if (name == "$upscope") {
      if (open_ == 0) words_.fail("$upscope ends a scope that no $scope began");
      --open_;
      h_.names.emplace_back(ScopeEnd());
    } else if (name == "$timescale") {
      read_scale(words_, section, h_);
    } else if (name == "$timezero") {
      if (section.size() != 1 || !read_whole(section[0], h_.time_zero))
        words_.fail(
            fmt::format("$timezero {}; expected a whole number", in_quotes(joined(section))));
    } else if (name == "$comment") {
      h_.names.emplace_back(Attribute{FST_AT_MISC, FST_MT_COMMENT, utf8_text(joined(section)), 0});
    } else if (name == "$version") {
      h_.writer = utf8_text(joined(section));
    } else if (name == "$date") {
      h_.date = utf8_text(joined(section));
    } else if (name == "$attrbegin") {
      attribute(section);
    }
    // Other sections belong to tools and do not describe signals.
  }

  /// Reads "misc 07 NAME ... ARGUMENT", as GTKWave writes it.
  void attribute(const std::vector<std::string>& section) {
    if (section.size() < 3 || section[0] != "misc") return;
    Attribute a;
    a.type = FST_AT_MISC;
    const std::string& sub = section[1];
    const auto read = std::from_chars(sub.data(), sub.data() + sub.size(), a.subtype, 16);
    if (read.ec != std::errc() || !read_whole(section.back(), a.argument)) return;
    if (a.subtype != FST_MT_ENUMTABLE && a.subtype != FST_MT_COMMENT) return;
    std::vector<std::string> name(section.begin() + 2, section.end() - 1);
    if (name.size() == 1 && name[0] == "\"\"") name.clear();
    a.name = utf8_text(joined(name));
    h_.names.emplace_back(std::move(a));
  }

  void variable(std::vector<std::string> section) {
    if (section.size() < 4)
      words_.fail(fmt::format("$var {}; expected a type, a width, an identifier and a name",
                              in_quotes(joined(section))));
    VariableName v;
    v.type = type_in(kVariableTypes, section[0], FST_VT_VCD_WIRE);
    if (section[0] == "in") v.direction = FST_VD_INPUT;
    if (section[0] == "out") v.direction = FST_VD_OUTPUT;
    if (section[0] == "inout") v.direction = FST_VD_INOUT;
    std::string range;
    v.width = width(section[1], range);
    if (section[1].starts_with('[')) range = section[1];
    v.name = name(section, range);
    if (v.type == FST_VT_GEN_STRING) {
      v.width = 0;
    } else if (v.type == FST_VT_VCD_REAL || v.type == FST_VT_VCD_REAL_PARAMETER ||
               v.type == FST_VT_VCD_REALTIME || v.type == FST_VT_SV_SHORTREAL) {
      v.width = 64;
    } else if (v.type == FST_VT_VCD_EVENT || v.width == 0) {
      v.width = 1;
    }
    const std::uint64_t most = kBitsOfSmallFiles + kBitsPerByte * words_.file_bytes();
    if ((bits_ += v.width) > most)
      words_.fail(
          fmt::format("$var of width {}: all signals so far have {} bits together; expected "
                      "at most {} in a file of {} bytes",
                      v.width, bits_, most, words_.file_bytes()));
    const bool real =
        v.width == 64 && (v.type == FST_VT_VCD_REAL || v.type == FST_VT_SV_SHORTREAL ||
                          v.type == FST_VT_VCD_REAL_PARAMETER || v.type == FST_VT_VCD_REALTIME);
    const bool event = v.type == FST_VT_VCD_EVENT;
    const auto [known, fresh] =
        handles_.emplace(std::tuple(section[2], v.width, real, event), h_.identifiers.size() + 1);
    if (fresh) {
      check_number_of(section[2]);
      h_.identifiers.push_back(section[2]);
      h_.widths.push_back(v.width);
      h_.types.push_back(v.type);
    }
    v.handle = static_cast<std::uint32_t>(known->second);
    h_.names.emplace_back(std::move(v));
  }

  /// Every change of an identifier is a change of all its signals.
  void check_number_of(const std::string& identifier) {
    unsigned number = 0;
    for (auto one = handles_.lower_bound(std::tuple(identifier, 0u, false, false));
         one != handles_.end() && std::get<0>(one->first) == identifier; ++one)
      ++number;
    if (number > kMostOfIdentifier)
      words_.fail(fmt::format("$var: identifier {} has more than {} different widths and types",
                              in_quotes(identifier), kMostOfIdentifier));
  }

  std::uint32_t width(const std::string& text, std::string& range) {
    std::uint32_t bits = 0;
    if (read_whole(text, bits) && bits <= 1u << 24) return bits;
    // Extended VCD writes [7:0].
    int left = 0, right = 0;
    const std::size_t colon = text.find(':');
    if (text.size() > 4 && text.front() == '[' && text.back() == ']' && colon != text.npos &&
        read_whole(std::string_view(text).substr(1, colon - 1), left) &&
        read_whole(std::string_view(text).substr(colon + 1, text.size() - colon - 2), right)) {
      const auto many = std::max(left, right) - std::int64_t{std::min(left, right)} + 1;
      range = text;
      if (many <= 1 << 24) return static_cast<std::uint32_t>(many);
    }
    words_.fail(fmt::format("$var of width {}; expected a number of bits up to {}", in_quotes(text),
                            1 << 24));
  }

  /// The name, with a blank before its range.
  static std::string name(const std::vector<std::string>& section, const std::string& range) {
    std::string text, index;
    std::size_t end = section.size();
    // "[7:0]" may contain blanks.
    for (std::size_t i = 4; i < end; ++i)
      if (section[i].starts_with('[') && section.back().ends_with(']')) {
        for (std::size_t k = i; k < end; ++k) {
          if (k != i && section[k].starts_with('[')) index += ' ';
          index += section[k];
        }
        end = i;
      }
    for (std::size_t i = 3; i < end; ++i) text += (i == 3 ? "" : " ") + section[i];
    if (index.empty()) index = range;
    return utf8_text(index.empty() ? text : text + ' ' + index);
  }

  WordReader& words_;
  VcdHeader h_;
  std::map<std::tuple<std::string, std::uint32_t, bool, bool>, std::size_t> handles_;
  std::size_t open_ = 0;
  std::uint64_t bits_ = 0;  ///< of all signals so far
};

}  // namespace

std::vector<std::string> vcd_section(WordReader& words, const std::string& name) {
  std::vector<std::string> all;
  std::string_view word;
  const std::uint64_t line = words.line();
  std::size_t bytes = 0;
  while (words.next(word)) {
    if (word == kEndWord) return all;
    bytes += word.size() + 1;
    if (bytes > kMostSection)
      words.fail(fmt::format("{} of line {} has no $end", in_quotes(name), line));
    std::string own(word);
    // "clk$end": a name may end like this, but then another $end follows.
    if (own.size() > kEndWord.size() && own.ends_with(kEndWord)) {
      const bool more = words.next(word);
      if (more && word == kEndWord) {
        all.push_back(std::move(own));
        return all;
      }
      if (more) words.again();
      own.resize(own.size() - kEndWord.size());
      all.push_back(std::move(own));
      return all;
    }
    all.push_back(std::move(own));
  }
  words.fail(
      fmt::format("the file ends within {} of line {}; expected $end", in_quotes(name), line));
}

std::string joined(const std::vector<std::string>& words, std::size_t from) {
  std::string text;
  for (std::size_t i = from; i < words.size(); ++i) text += (i == from ? "" : " ") + words[i];
  return text;
}

VcdHeader read_vcd_header(WordReader& words) {
  return HeaderReader(words).read();
}

}  // namespace cde::wave
