// SPDX-License-Identifier: Apache-2.0
#include "cde/bvh/bvh.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "support/file_io.hpp"
#include "support/sha256.hpp"

namespace cde {
namespace {

using bvh::Node;

/// A file has this line, then 32-bit words, least byte first. First come the numbers of nodes,
/// secondaries and parts, the box (lower corner, upper corner), the nodes and the order. Then
/// follow for each part its first node and its numbers of nodes and secondaries. The SHA-256 of all
/// these bytes ends the file, in hexadecimal digits.
constexpr std::string_view kMagic = "cde.bvh.4\n";
constexpr std::size_t kHeadWords = 9, kDigits = 64, kPartWords = 3;

void put(std::string& to, std::uint32_t word) {
  for (unsigned byte = 0; byte < 4; ++byte) to += static_cast<char>(word >> (8 * byte) & 0xff);
}

class SavedWords {
 public:
  explicit SavedWords(std::string_view bytes) : bytes_(bytes) {}
  [[nodiscard]] std::size_t left() const { return bytes_.size() / 4; }
  std::uint32_t next() {
    std::uint32_t word = 0;
    for (unsigned byte = 0; byte < 4; ++byte)
      word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes_[byte])) << (8 * byte);
    bytes_.remove_prefix(4);
    return word;
  }
  float next_float() { return std::bit_cast<float>(next()); }

 private:
  std::string_view bytes_;
};

double area(const Eigen::Vector3d& extent) {
  return extent.x() * extent.y() + extent.y() * extent.z() + extent.z() * extent.x();
}

}  // namespace

Bvh::Bvh() : nodes_(1) {}

/// A line that crosses a convex body crosses a convex body within it with the ratio of their
/// surface areas as its probability.
Bvh::Visits Bvh::expected_visits() const {
  Visits visits{.nodes = 1};
  const double whole = box_.isEmpty() ? 0 : area(box_.sizes().cast<double>());
  for (const Node& node : nodes_) {
    for (unsigned i = 0; i < Node::kChildren; ++i) {
      Eigen::Vector3d extent;
      for (int k = 0; k < 3; ++k)
        extent[k] = std::ldexp(node.upper(i, k) - node.lower(i, k), node.exponent(k));
      const double share = whole > 0 ? std::min(1.0, area(extent) / whole) : 1;
      if (node.child(i) == bvh::Child::kNode) visits.nodes += share;
      visits.secondaries += share * slots_of(node.child(i));
    }
  }
  return visits;
}

void Bvh::save(const std::filesystem::path& path) const {
  std::string bytes(kMagic);
  bytes.reserve(
      kMagic.size() +
      4 * (kHeadWords + nodes_.size() * Node::kWords + order_.size() + kPartWords * parts_.size()) +
      kDigits);
  put(bytes, static_cast<std::uint32_t>(nodes_.size()));
  put(bytes, static_cast<std::uint32_t>(order_.size()));
  put(bytes, static_cast<std::uint32_t>(parts_.size()));
  for (const Eigen::Vector3f& corner : {box_.min(), box_.max()})
    for (const float x : corner) put(bytes, std::bit_cast<std::uint32_t>(x));
  for (const Node& node : nodes_)
    for (const std::uint32_t word : node.words) put(bytes, word);
  for (const std::uint32_t index : order_) put(bytes, index);
  for (const Part& part : parts_)
    for (const std::uint32_t word : {part.first_node, part.nodes, part.secondaries})
      put(bytes, word);
  bytes += sha256(bytes);
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

Bvh Bvh::load(const std::filesystem::path& path) {
  const std::string bytes = file_io::read(path);
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(path.string()), what));
  };
  if (!bytes.starts_with("cde.bvh.")) fail("not a BVH file (cde.bvh.4)");
  if (!bytes.starts_with(kMagic)) fail("a BVH file of another version; expected cde.bvh.4");
  const std::size_t head = kMagic.size() + 4 * kHeadWords;
  if (bytes.size() < head + kDigits) fail("a BVH file that is truncated in its header");
  SavedWords words(
      std::string_view(bytes).substr(kMagic.size(), bytes.size() - kMagic.size() - kDigits));
  const std::size_t nodes = words.next(), slots = words.next(), parts = words.next();
  const std::size_t size = head + 4 * (nodes * Node::kWords + slots + kPartWords * parts) + kDigits;
  if (bytes.size() != size)
    fail(fmt::format(
        "a BVH file of {} nodes, {} secondaries and {} parts has {} bytes; this file has {}", nodes,
        slots, parts, size, bytes.size()));
  const std::size_t end = bytes.size() - kDigits;
  if (sha256(std::string_view(bytes).substr(0, end)) != std::string_view(bytes).substr(end))
    fail("a damaged BVH file: its checksum differs");
  Bvh read;
  for (Eigen::Vector3f* corner : {&read.box_.min(), &read.box_.max()})
    for (float& x : *corner) x = words.next_float();
  read.nodes_.resize(nodes);
  for (Node& node : read.nodes_)
    for (std::uint32_t& word : node.words) word = words.next();
  std::vector<bool> there(slots, false);
  for (std::size_t s = 0; s < slots; ++s) {
    const std::uint32_t index = words.next();
    if (index >= slots || there[index])
      fail(fmt::format("slot {} has secondary {}, which {}", s, index,
                       index >= slots ? "does not exist" : "is also in another slot"));
    there[index] = true;
    read.order_.push_back(index);
  }
  for (std::size_t k = 0; k < parts; ++k) {
    const std::uint32_t first = words.next(), below = words.next();
    read.parts_.push_back({first, below, words.next()});
  }
  try {
    read.depth_ = bvh::check(read.nodes_, slots);
    bvh::check(read.nodes_, slots, read.parts_);
  } catch (const Error& e) {
    fail(e.what());
  }
  // The margin of a ray follows from this box.
  if (slots != 0 && (!read.box_.max().allFinite() || read.box_.min() != read.nodes_[0].origin()))
    fail("its box differs from its root's");
  return read;
}

}  // namespace cde
