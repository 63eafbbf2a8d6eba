// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace cde::netlist {

/// The input is not a design as Verilator writes it.
class NetlistError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An element of Verilator's XML. It lives as long as its netlist.
class Element {
 public:
  [[nodiscard]] std::string_view tag() const { return tag_; }
  /// As written, with entities; empty if missing.
  [[nodiscard]] std::string_view attribute(std::string_view name) const;
  [[nodiscard]] std::string text(std::string_view name) const;  ///< with entities decoded
  [[nodiscard]] unsigned number(std::string_view name) const;   ///< decimal; 0 if missing
  [[nodiscard]] const std::vector<const Element*>& children() const { return children_; }
  /// Child `index`; null if there are fewer.
  [[nodiscard]] const Element* child(std::size_t index) const {
    return index < children_.size() ? children_[index] : nullptr;
  }

 private:
  friend class Netlist;
  std::string_view tag_, attributes_;
  std::vector<const Element*> children_;
};

/// A type of signals.
struct Type {
  enum class Kind { kBits, kPacked, kUnpacked, kStructure, kOther };
  struct Member {
    std::string name;
    unsigned type = 0, low = 0;  ///< lowest bit; 0 for the last member
  };
  Kind kind = Kind::kOther;
  std::uint64_t width = 0;      ///< of all elements; 0: unknown
  unsigned element = 0;         ///< type of the elements of an array
  int left = 0, right = 0;      ///< range of an array, as declared
  std::vector<Member> members;  ///< of a structure
};

/// A line of a source.
struct Line {
  std::string file;  ///< as passed to Verilator
  unsigned line = 0;
  unsigned column = 0, length = 0;  ///< of an element's first word, in its line; 0: unknown
};

/// A design as Verilator elaborates it and writes it as XML: modules with parameters set, not yet
/// inlined. Only this class reads that form.
class Netlist {
 public:
  /// NetlistError if the text is not such a design.
  explicit Netlist(std::string xml);

  /// Bytes of the text.
  [[nodiscard]] std::size_t bytes() const { return text_->size(); }
  /// `<netlist>`, whose children are the modules, and `<cells>`, the instances.
  [[nodiscard]] const Element& netlist() const { return *netlist_; }
  [[nodiscard]] const Element& cells() const { return *cells_; }
  [[nodiscard]] const std::map<std::string, std::string, std::less<>>& files() const {
    return files_;
  }
  /// Where an element begins; without a file if the element does not say.
  [[nodiscard]] Line line(const Element& element) const;
  /// An unknown type has kind kOther and no width.
  [[nodiscard]] const Type& type(unsigned id) const;
  [[nodiscard]] const Type& type_of(const Element& element) const {
    return type(element.number("dtype_id"));
  }

 private:
  void read_types(const Element& table);
  std::uint64_t width(unsigned id, unsigned depth);

  std::unique_ptr<const std::string> text_;  // elements have views of it
  std::deque<Element> elements_;
  const Element* netlist_ = nullptr;
  const Element* cells_ = nullptr;
  std::map<std::string, std::string, std::less<>> files_;  ///< letters -> name
  std::map<unsigned, Type> types_;        // files choose the numbers, so a hash would not do
  std::set<unsigned> measured_;           ///< types whose widths are being computed
  std::map<unsigned, unsigned> aliases_;  ///< types that are aliases of others
};

/// Bits of a constant such as 8'h1f, most significant first: 0, 1, x or z. Empty if the element is
/// not one.
[[nodiscard]] std::string constant_bits(const Element& constant);

}  // namespace cde::netlist
