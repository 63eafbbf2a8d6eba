// SPDX-License-Identifier: Apache-2.0
#include "cde/jobs/mpi_ranks.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <cstdlib>
#include <type_traits>

#include "cde/support/error.hpp"
#include "jobs/mpi_requests.hpp"

namespace cde::mpi {
namespace {

constexpr std::size_t kMostAtOnce = 1 << 30;  ///< bytes per call, whose counts are ints

/// Sends bytes from rank 0 to the same room on all other ranks.
void broadcast_bytes(char* bytes, std::size_t count) {
  for (std::size_t at = 0; at < count; at += kMostAtOnce) {
    MPI_Request request;
    MPI_Ibcast(bytes + at, static_cast<int>(std::min(kMostAtOnce, count - at)), MPI_BYTE, 0,
               MPI_COMM_WORLD, &request);
    finish(request);
  }
}

template <class List>
void broadcast_list(List& list) {
  static_assert(std::is_trivially_copyable_v<typename List::value_type> ||
                std::is_same_v<typename List::value_type, Eigen::Vector3f>);
  std::uint64_t size = list.size();
  broadcast_bytes(reinterpret_cast<char*>(&size), sizeof size);
  list.resize(size);
  broadcast_bytes(reinterpret_cast<char*>(list.data()), size * sizeof(typename List::value_type));
}

}  // namespace

bool Ranks::started() noexcept {
  return std::ranges::any_of(
      std::initializer_list<const char*>{"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"},
      [](const char* name) { return std::getenv(name) != nullptr; });
}

Ranks::Ranks() {
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
  if (provided < MPI_THREAD_SERIALIZED)
    throw Error(ErrorCode::kConfiguration, "this MPI cannot be used from a second thread");
  int rank = 0, size = 1, length = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  rank_ = static_cast<unsigned>(rank);
  size_ = static_cast<unsigned>(size);
  std::string host(MPI_MAX_PROCESSOR_NAME, '\0');
  MPI_Get_processor_name(host.data(), &length);
  host.resize(static_cast<std::size_t>(length));
  hosts_ = all_of(host);
}

Ranks::~Ranks() {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  finish(request);
  MPI_Finalize();
}

std::string Ranks::place(unsigned rank) const {
  return fmt::format("rank {} on {}", rank, host(rank));
}

std::string Ranks::broadcast(std::string bytes) const {
  broadcast_list(bytes);
  return bytes;
}

void Ranks::broadcast(Mesh& mesh) const {
  broadcast_list(mesh.vertices);
  broadcast_list(mesh.faces);
  mesh.name = broadcast(std::move(mesh.name));
  std::string parts;
  put_number<std::uint64_t>(parts, mesh.dropped);
  for (const MeshPart& part : mesh.parts) {
    put_number(parts, part.first_face);
    put_number<std::uint64_t>(parts, part.name.size());
    parts += part.name;
  }
  parts = broadcast(std::move(parts));
  if (rank_ == 0) return;
  mesh.dropped = take_number<std::uint64_t>(parts, 0);
  mesh.parts.clear();
  for (std::size_t at = 8; at < parts.size();) {
    MeshPart part{.name = {}, .first_face = take_number<std::uint32_t>(parts, at)};
    const auto size = take_number<std::uint64_t>(parts, at + 4);
    part.name = parts.substr(at + 12, size);
    at += 12 + size;
    mesh.parts.push_back(std::move(part));
  }
}

std::string Ranks::scatter(const std::function<std::string(unsigned)>& of) const {
  enum Tag { kSize = 100, kPiece };
  std::string bytes;
  MPI_Request request;
  if (rank_ == 0) {
    for (unsigned to = size_ - 1; to > 0; --to) {
      bytes = of(to);
      std::uint64_t size = bytes.size();
      MPI_Isend(&size, sizeof size, MPI_BYTE, static_cast<int>(to), kSize, MPI_COMM_WORLD,
                &request);
      finish(request);
      for (std::size_t at = 0; at < size; at += kMostAtOnce) {
        MPI_Isend(bytes.data() + at, static_cast<int>(std::min(kMostAtOnce, size - at)), MPI_BYTE,
                  static_cast<int>(to), kPiece, MPI_COMM_WORLD, &request);
        finish(request);
      }
    }
    return of(0);
  }
  std::uint64_t size = 0;
  MPI_Irecv(&size, sizeof size, MPI_BYTE, 0, kSize, MPI_COMM_WORLD, &request);
  finish(request);
  bytes.resize(size);
  for (std::size_t at = 0; at < size; at += kMostAtOnce) {
    MPI_Irecv(bytes.data() + at, static_cast<int>(std::min<std::size_t>(kMostAtOnce, size - at)),
              MPI_BYTE, 0, kPiece, MPI_COMM_WORLD, &request);
    finish(request);
  }
  return bytes;
}

std::vector<std::string> Ranks::all_of(const std::string& bytes) const {
  // One rank after the other: each sends a line, once per run.
  std::vector<std::string> all(size_);
  for (unsigned from = 0; from < size_; ++from) {
    std::uint64_t size = bytes.size();
    MPI_Request request;
    MPI_Ibcast(&size, sizeof size, MPI_BYTE, static_cast<int>(from), MPI_COMM_WORLD, &request);
    finish(request);
    all[from] = bytes;
    all[from].resize(size);
    MPI_Ibcast(all[from].data(), static_cast<int>(size), MPI_BYTE, static_cast<int>(from),
               MPI_COMM_WORLD, &request);
    finish(request);
  }
  return all;
}

void Ranks::abort(int status) const {
  MPI_Abort(MPI_COMM_WORLD, status);
  std::abort();
}

}  // namespace cde::mpi
