// SPDX-License-Identifier: Apache-2.0
#include "io/array_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "support/text.hpp"

namespace cde::io {
namespace {

constexpr std::size_t kMostHeader = 65536;  // numpy.load accepts 10,000

/// A value in Python's notation.
struct Literal {
  enum class Kind { kText, kNumber, kWord, kList, kTuple, kDict } kind = Kind::kWord;
  std::string text = {};  ///< for kText and kWord
  std::uint64_t number = 0;
  std::vector<Literal> items = {};  ///< for kDict: keys and values alternate
};

struct NotPython {
  std::size_t at;
};

/// Reads texts, whole numbers from 0, True, False, None, and lists, tuples and dictionaries of
/// them.
class LiteralReader {
 public:
  explicit LiteralReader(std::string_view text) : text_(text) {}

  Literal whole() {
    Literal value = read(0);
    if (peek() != '\0' || at_ != text_.size()) throw NotPython{at_};
    return value;
  }

 private:
  [[nodiscard]] char peek() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t'))
      ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  void take(char c) {
    if (peek() != c || at_ == text_.size()) throw NotPython{at_};
    ++at_;
  }

  Literal read(unsigned depth) {
    if (depth > 16) throw NotPython{at_};
    const char c = peek();
    if (c == '\'' || c == '"') return quoted(c);
    if (c == '[') return list(Literal::Kind::kList, ']', depth);
    if (c == '(') return list(Literal::Kind::kTuple, ')', depth);
    if (c == '{') return list(Literal::Kind::kDict, '}', depth);
    const std::size_t first = at_;
    const auto is_word = [](char x) {
      return (x >= '0' && x <= '9') || (x >= 'a' && x <= 'z') || (x >= 'A' && x <= 'Z');
    };
    while (at_ < text_.size() && is_word(text_[at_])) ++at_;
    const std::string_view word = text_.substr(first, at_ - first);
    if (word.empty()) throw NotPython{at_};
    Literal value{.text = std::string(word)};
    // Python 2 wrote long numbers as 6L.
    if (text::parse_int(word.substr(0, word.size() - (word.ends_with('L') ? 1 : 0)), value.number))
      value.kind = Literal::Kind::kNumber;
    return value;
  }

  Literal quoted(char quote) {
    Literal value{.kind = Literal::Kind::kText};
    for (++at_; at_ < text_.size() && text_[at_] != quote; ++at_) {
      if (text_[at_] == '\\') ++at_;
      if (at_ < text_.size()) value.text += text_[at_];
    }
    if (at_ >= text_.size()) throw NotPython{text_.size()};
    ++at_;
    return value;
  }

  Literal list(Literal::Kind kind, char last, unsigned depth) {
    Literal value{.kind = kind};
    ++at_;
    std::size_t commas = 0;
    while (peek() != last) {
      value.items.push_back(read(depth + 1));
      if (kind == Literal::Kind::kDict) {
        take(':');
        value.items.push_back(read(depth + 1));
      }
      if (peek() != last) take(','), ++commas;
    }
    ++at_;
    // (3) is a number, not a tuple.
    if (kind == Literal::Kind::kTuple && value.items.size() == 1 && commas == 0)
      return Literal(value.items.front());
    return value;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

class HeaderReader {
 public:
  HeaderReader(const std::string& name, const std::string& expected)
      : name_(name), expected_(expected) {}

  ArrayHeader read(std::string_view bytes) {
    const std::string_view text = text_of(bytes);
    Literal dict;
    try {
      dict = LiteralReader(text).whole();
    } catch (const NotPython& e) {
      fail(fmt::format("its header, byte {}: not a Python dictionary", e.at));
    }
    if (dict.kind != Literal::Kind::kDict) fail("its header is not a Python dictionary");
    header_.fortran_order = flag(value(dict, "fortran_order"));
    header_.shape = shape(value(dict, "shape"));
    take_type(value(dict, "descr"));
    check_size(bytes.size() - header_.data);
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", name_, why));
  }

  std::string_view text_of(std::string_view bytes) {
    if (!bytes.starts_with(kArrayMark) || bytes.size() < 10) fail("is not a NumPy array (.npy)");
    const auto at = [&](std::size_t i) {
      return std::size_t{static_cast<unsigned char>(bytes[i])};
    };
    const std::size_t version = at(6), start = version == 1 ? 10 : 12;
    if (version < 1 || version > 3 || bytes.size() < start)
      fail(fmt::format("NumPy format {}.{}, expected 1.0 to 3.0", version, at(7)));
    std::size_t length = at(8) | at(9) << 8;
    if (version > 1) length |= at(10) << 16 | at(11) << 24;
    if (length > bytes.size() - start) fail("is truncated in its header");
    if (length > kMostHeader)
      fail(fmt::format("its header has {} bytes, expected at most {}", length, kMostHeader));
    header_.data = start + length;
    return bytes.substr(start, length);
  }

  const Literal& value(const Literal& dict, std::string_view key) const {
    for (std::size_t i = 0; i + 1 < dict.items.size(); i += 2)
      if (dict.items[i].kind == Literal::Kind::kText && dict.items[i].text == key)
        return dict.items[i + 1];
    fail(fmt::format("its header has no '{}'", key));
  }

  bool flag(const Literal& value) const {
    const bool known = value.kind == Literal::Kind::kWord;
    if (known && value.text == "True") return true;
    if (known && value.text == "False") return false;
    fail("its header: fortran_order is neither True nor False");
  }

  std::vector<std::uint64_t> shape(const Literal& value) const {
    std::vector<std::uint64_t> all;
    if (value.kind != Literal::Kind::kTuple) fail("its header: shape is not a tuple");
    for (const Literal& item : value.items) {
      if (item.kind != Literal::Kind::kNumber) fail("its header: shape is not a tuple of numbers");
      all.push_back(item.number);
    }
    return all;
  }

  NumberType number_type(const std::string& text, const std::string& whose) const {
    std::string_view rest = text;
    NumberType type;
    if (!rest.empty() && std::string_view("<>|=").find(rest.front()) != std::string_view::npos) {
      type.big_endian = rest.front() == '>';
      rest.remove_prefix(1);
    }
    std::uint32_t bytes = 0;
    const char kind = rest.empty() ? '\0' : rest.front();
    const bool whole = kind == 'i' || kind == 'u';
    if ((kind == 'f' || whole) && text::parse_int(rest.substr(1), bytes) &&
        (bytes == 2 || bytes == 4 || bytes == 8 || (whole && bytes == 1))) {
      type.kind = kind;
      type.bytes = bytes;
      return type;
    }
    fail(
        fmt::format("{} {}; expected floats of 2, 4 or 8 bytes ('<f2', '<f4', '<f8') or whole "
                    "numbers ('<i4'), in either byte order",
                    whose, in_quotes(text)));
  }

  void take_type(const Literal& descr) {
    if (descr.kind == Literal::Kind::kText) {
      header_.fields.push_back({"", number_type(descr.text, "its numbers are"), 1, 0});
      header_.element_bytes = header_.fields.front().type.bytes;
      return;
    }
    if (descr.kind != Literal::Kind::kList) fail("its header: descr is neither a type nor a list");
    header_.structured = true;
    for (const Literal& field : descr.items) take_field(field);
  }

  void take_field(const Literal& field) {
    if (field.kind != Literal::Kind::kTuple || field.items.size() < 2 || field.items.size() > 3)
      fail("its header: a field is not (name, type) or (name, type, shape)");
    const Literal &name = field.items[0], &type = field.items[1];
    if (name.kind != Literal::Kind::kText)
      fail(fmt::format("its fields have titles besides names; {}", expected_));
    if (type.kind != Literal::Kind::kText)
      fail(fmt::format("its field {} is a structure; {}", in_quotes(name.text), expected_));
    std::uint32_t padding = 0;
    if (name.text.empty() && type.text.starts_with("|V") &&
        text::parse_int(std::string_view(type.text).substr(2), padding)) {
      header_.element_bytes += padding;
      return;
    }
    ArrayField one{name.text,
                   number_type(type.text, fmt::format("the numbers of its field {} are",
                                                      in_quotes(name.text))),
                   1, header_.element_bytes};
    if (field.items.size() == 3) {
      const Literal& of = field.items[2];
      one.count = product(of.kind == Literal::Kind::kNumber ? std::vector{of.number} : shape(of));
    }
    header_.element_bytes += product({one.count, one.type.bytes});
    header_.fields.push_back(std::move(one));
  }

  [[nodiscard]] std::uint64_t product(const std::vector<std::uint64_t>& factors) const {
    std::uint64_t all = 1;
    if (std::find(factors.begin(), factors.end(), 0u) != factors.end()) return 0;
    for (const std::uint64_t factor : factors) {
      if (all > (std::uint64_t{1} << 48) / factor) fail("its header claims an impossible size");
      all *= factor;
    }
    return all;
  }

  void check_size(std::uint64_t bytes) {
    header_.elements = product(header_.shape);
    if (product({header_.elements, header_.element_bytes}) != bytes)
      fail(fmt::format("has {} bytes behind its header; its shape {} takes {}", bytes,
                       shape_text(header_.shape), header_.elements * header_.element_bytes));
  }

  const std::string &name_, &expected_;
  ArrayHeader header_;
};

}  // namespace

ArrayHeader read_array_header(std::string_view bytes, const std::string& name,
                              const std::string& expected) {
  return HeaderReader(name, expected).read(bytes);
}

std::string shape_text(const std::vector<std::uint64_t>& shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

}  // namespace cde::io
