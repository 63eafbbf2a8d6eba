// SPDX-License-Identifier: Apache-2.0
#include "cast/parts.hpp"

#include <algorithm>
#include <cstring>

#include "cde/contract/records.hpp"

namespace cde::cli {
namespace {

constexpr std::uint32_t kNone = ~0u;

/// Whether the record of a later part replaces the record of an earlier part. On a tie the lower
/// index wins, so the earlier part.
bool is_better(Mode mode, const Record& later, const Record& earlier) {
  if (!later.f || later.bad) return false;
  if (!earlier.f) return true;
  if (mode == Mode::kNearest) return later.t < earlier.t;
  if (mode == Mode::kFarthest) return later.t > earlier.t;
  return false;  // mode any keeps the first record in stream order
}

template <class List>
void append_list(const List& list, std::string& to) {
  const std::uint64_t size = list.size();
  to.append(reinterpret_cast<const char*>(&size), sizeof size);
  to.append(reinterpret_cast<const char*>(list.data()), size * sizeof list[0]);
}
template <class List>
void take_list(const std::string& from, std::size_t& at, List& list) {
  std::uint64_t size = 0;
  std::memcpy(&size, from.data() + at, sizeof size);
  list.resize(size);
  std::memcpy(static_cast<void*>(list.data()), from.data() + at + sizeof size,
              size * sizeof list[0]);
  at += sizeof size + size * sizeof list[0];
}

}  // namespace

std::uint64_t first_face_of(std::uint64_t faces, unsigned part, unsigned parts) {
  return faces / parts * part + std::min<std::uint64_t>(part, faces % parts);
}

Mesh part_of(const Mesh& mesh, std::uint64_t first, std::uint64_t count) {
  Mesh part;
  part.name = mesh.name;
  part.faces.reserve(count);
  std::vector<std::uint32_t> number(mesh.vertices.size(), kNone);
  for (std::uint64_t i = first; i < first + count; ++i) {
    auto face = mesh.faces[i];
    for (std::uint32_t& corner : face) {
      if (number[corner] == kNone) {
        number[corner] = static_cast<std::uint32_t>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[corner]);
      }
      corner = number[corner];
    }
    part.faces.push_back(face);
  }
  return part;
}

void append_mesh(const Mesh& mesh, std::string& to) {
  append_list(mesh.vertices, to);
  append_list(mesh.faces, to);
}

Mesh mesh_at(const std::string& bytes, std::size_t& at) {
  Mesh mesh;
  take_list(bytes, at, mesh.vertices);
  take_list(bytes, at, mesh.faces);
  return mesh;
}

std::vector<Record> reduced(Mode mode, std::vector<std::vector<Record>> parts,
                            const std::vector<std::uint64_t>& firsts) {
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (Record& r : parts[p])
      if (r.index != kNone) r.index += static_cast<std::uint32_t>(firsts[p]);
  if (mode != Mode::kAll && mode != Mode::kHits) {
    std::vector<Record> best = std::move(parts[0]);
    for (std::size_t p = 1; p < parts.size(); ++p)
      for (std::size_t i = 0; i < best.size(); ++i)
        if (is_better(mode, parts[p][i], best[i])) best[i] = parts[p][i];
    return best;
  }
  std::vector<Record> all;
  std::vector<std::size_t> next(parts.size(), 0);
  for (bool more = true; more;) {
    more = false;
    // The next packet is the lowest one with records in any part.
    std::uint64_t packet = kNone;
    for (std::size_t p = 0; p < parts.size(); ++p)
      if (next[p] < parts[p].size())
        packet = std::min(packet, parts[p][next[p]].primary / card::kMostPrimaries);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      for (;
           next[p] < parts[p].size() && parts[p][next[p]].primary / card::kMostPrimaries == packet;
           ++next[p]) {
        all.push_back(parts[p][next[p]]);
        more = true;
      }
    }
  }
  return all;
}

}  // namespace cde::cli
