// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "cde/bvh/bvh.hpp"
#include "cde/support/scratch.hpp"

namespace cde::testing {

/// Makes a BVH with other nodes and another box, through its file format with a new checksum.
inline Bvh rewritten(const Bvh& bvh, const std::vector<bvh::Node>& nodes,
                     const Eigen::AlignedBox3f& box) {
  namespace fs = std::filesystem;
  const Scratch folder("cde-rewritten");
  const fs::path file = folder / "bvh", sum = folder / "sum";
  const auto bytes_of = [](const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  bvh.save(file);
  std::string bytes = bytes_of(file);
  bytes.resize(bytes.size() - 64);
  std::size_t at = 10 + 3 * 4;  // after the first line and three numbers
  const auto put = [&](std::uint32_t word) {
    for (unsigned b = 0; b < 4; ++b) bytes[at++] = static_cast<char>(word >> (8 * b) & 0xff);
  };
  for (const Eigen::Vector3f& corner : {box.min(), box.max()})
    for (const float x : corner) put(std::bit_cast<std::uint32_t>(x));
  for (const bvh::Node& node : nodes)
    for (const std::uint32_t word : node.words) put(word);
  std::ofstream(file, std::ios::binary) << bytes;
  const std::string command = "sha256sum <'" + file.string() + "' >'" + sum.string() + "'";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("no sha256sum");
  std::ofstream(file, std::ios::binary | std::ios::app) << bytes_of(sum).substr(0, 64);
  return Bvh::load(file);
}

}  // namespace cde::testing
