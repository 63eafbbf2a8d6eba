// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/mesh/mesh.hpp"

/// @file
/// Several processes on one or more machines, by MPI. It is a separate library (cde::mpi), so that
/// the driver does not depend on MPI.
namespace cde::mpi {

/// A piece of work that rank 0 assigns.
struct Chunk {
  std::uint64_t number = 0;
  std::string input;                  ///< at most 2^31 - 64 bytes, like a result
  std::optional<unsigned> rank = {};  ///< rank that must run it; none: any free rank
};

/// Work assigned on demand: a slow rank gets less of it.
struct Work {
  /// On rank 0: the next chunk. Nothing if too many chunks wait for an earlier one, or if there are
  /// no more.
  std::function<std::optional<Chunk>()> next;
  /// On rank 0: whether next() may still return a chunk. Called when all assigned chunks are done.
  std::function<bool()> more;
  /// On every rank, rank 0 included: result of a chunk.
  std::function<std::string(const Chunk&)> run;
  /// On rank 0: receives results in the order of their arrival.
  std::function<void(std::uint64_t number, std::string result)> done;
};

/// The MPI ranks of this process's job. One instance per process; MPI begins and ends with it.
class Ranks {
 public:
  /// Whether a launcher (mpirun, srun with PMI) started this process, judged by the environment.
  [[nodiscard]] static bool started() noexcept;

  /// Error kConfiguration if MPI cannot be used from a second thread.
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  [[nodiscard]] unsigned rank() const { return rank_; }
  [[nodiscard]] unsigned size() const { return size_; }
  /// Host name of a rank, as reported by that rank.
  [[nodiscard]] const std::string& host(unsigned rank) const { return hosts_.at(rank); }
  /// "rank 3 on node7".
  [[nodiscard]] std::string place(unsigned rank) const;

  // Collective: all ranks call these in the same order.

  /// Rank 0's bytes, on every rank.
  [[nodiscard]] std::string broadcast(std::string bytes) const;
  /// Rank 0's mesh, on every rank. Its `files` stay on rank 0.
  void broadcast(Mesh& mesh) const;
  /// Each rank gets the bytes that `of` makes for it on rank 0, one rank after another.
  [[nodiscard]] std::string scatter(const std::function<std::string(unsigned rank)>& of) const;
  /// The bytes of all ranks, by rank, on every rank.
  [[nodiscard]] std::vector<std::string> all_of(const std::string& bytes) const;

  /// Runs the work until there is no more. On rank 0 a separate thread calls next(), more() and
  /// done() while run() executes. An exception of these functions ends the work on all ranks. Rank
  /// 0 rethrows it with the originating rank and host as a prefix. The others throw an Error that
  /// says so. Waiting uses no processor time.
  void distribute(const Work& work) const;

  /// Ends all ranks at once.
  [[noreturn]] void abort(int status) const;

 private:
  unsigned rank_ = 0, size_ = 1;
  std::vector<std::string> hosts_;
};

}  // namespace cde::mpi
