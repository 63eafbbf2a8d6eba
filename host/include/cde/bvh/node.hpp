// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstdint>

namespace cde::bvh {

/// Type of one of a node's eight children.
enum class Child : std::uint8_t { kNone, kNode, kLeafOfOne, kLeafOfTwo };

/// Number of secondaries of a leaf.
[[nodiscard]] constexpr unsigned slots_of(Child child) {
  return child == Child::kLeafOfOne ? 1 : child == Child::kLeafOfTwo ? 2 : 0;
}

/// A node in the card's format: 18 words, 72 bytes, one burst of the DDR.
///
///     words    bits
///     0..2     origin, fp32: the lower corner of all its children
///     3..5     lower corners of children 0 to 3, a byte each: x, then y, then z
///     6..8     upper corners likewise
///     9        [7:0] [15:8] [23:16] exponents of x, y, z, signed; [31:24] children 0 to 3
///     10       [27:0] number of its first node; [31:28] children 4 and 5
///     11       [27:0] slot of its first secondary; [31:28] children 6 and 7
///     12..14   lower corners of children 4 to 7
///     15..17   upper corners likewise
///
/// Words 0 to 8 and 9 to 17 are its halves, a beat of the DDR each. A child's type has two bits
/// (Child). A corner is origin + byte 2^exponent. The box of a child contains everything below the
/// child, exactly. Child nodes and secondaries of a node are stored consecutively, in the order of
/// the children (compressed wide nodes: Ylitie, Karras, Laine, HPG 2017).
struct Node {
  static constexpr unsigned kChildren = 8, kWords = 18;
  static constexpr std::uint32_t kMostNumber = (1u << 28) - 1;
  /// Exponents of the units of the corner bytes. With lengths up to 2^40, everything computed from
  /// them and a ray within the contract is a normal number.
  static constexpr int kLeastExponent = -80, kMostExponent = 40;

  std::array<std::uint32_t, kWords> words{};

  [[nodiscard]] Eigen::Vector3f origin() const {
    return {std::bit_cast<float>(words[0]), std::bit_cast<float>(words[1]),
            std::bit_cast<float>(words[2])};
  }
  [[nodiscard]] int exponent(int axis) const {
    return static_cast<std::int8_t>(words[kExponents] >> (8 * axis));
  }
  [[nodiscard]] Child child(unsigned i) const {
    const std::uint32_t two = i < 4   ? words[kExponents] >> (24 + 2 * i)
                              : i < 6 ? words[kFirstNode] >> (28 + 2 * (i - 4))
                                      : words[kFirstSlot] >> (28 + 2 * (i - 6));
    return static_cast<Child>(two & 3);
  }
  [[nodiscard]] std::uint32_t first_node() const { return words[kFirstNode] & kMostNumber; }
  [[nodiscard]] std::uint32_t first_slot() const { return words[kFirstSlot] & kMostNumber; }
  [[nodiscard]] std::uint8_t lower(unsigned i, int axis) const { return byte(false, i, axis); }
  [[nodiscard]] std::uint8_t upper(unsigned i, int axis) const { return byte(true, i, axis); }

  /// Position of child i: the number of a node, or the slot of a leaf's first secondary.
  [[nodiscard]] std::uint32_t place(unsigned i) const {
    const bool node = child(i) == Child::kNode;
    std::uint32_t at = node ? first_node() : first_slot();
    for (unsigned before = 0; before < i; ++before)
      at += node ? (child(before) == Child::kNode ? 1 : 0) : slots_of(child(before));
    return at;
  }

  void set_origin(const Eigen::Vector3f& o) {
    for (int k = 0; k < 3; ++k)
      words[static_cast<unsigned>(k)] = std::bit_cast<std::uint32_t>(o[k]);
  }
  void set_exponent(int axis, int e) {
    words[kExponents] &= ~(0xffu << (8 * axis));
    words[kExponents] |= (static_cast<std::uint32_t>(e) & 0xff) << (8 * axis);
  }
  void set_child(unsigned i, Child child) {
    std::uint32_t& word = words[i < 4 ? kExponents : i < 6 ? kFirstNode : kFirstSlot];
    const unsigned shift = i < 4 ? 24 + 2 * i : i < 6 ? 28 + 2 * (i - 4) : 28 + 2 * (i - 6);
    word = (word & ~(3u << shift)) | static_cast<std::uint32_t>(child) << shift;
  }
  void set_first_node(std::uint32_t n) {
    words[kFirstNode] = (words[kFirstNode] & ~kMostNumber) | n;
  }
  void set_first_slot(std::uint32_t n) {
    words[kFirstSlot] = (words[kFirstSlot] & ~kMostNumber) | n;
  }
  void set_corner(bool upper, unsigned i, int axis, std::uint8_t q) {
    std::uint32_t& word = words[corner(upper, i, axis)];
    word = (word & ~(0xffu << (8 * (i % 4)))) | static_cast<std::uint32_t>(q) << (8 * (i % 4));
  }

  bool operator==(const Node&) const = default;

 private:
  static constexpr unsigned kExponents = 9, kFirstNode = 10, kFirstSlot = 11;
  /// The word of a child's corner.
  [[nodiscard]] static unsigned corner(bool upper, unsigned i, int axis) {
    return (i < 4 ? 0 : kWords / 2) + (upper ? 6 : 3) + static_cast<unsigned>(axis);
  }
  [[nodiscard]] std::uint8_t byte(bool upper, unsigned i, int axis) const {
    return static_cast<std::uint8_t>(words[corner(upper, i, axis)] >> (8 * (i % 4)));
  }
};

}  // namespace cde::bvh
