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

/// Many processes on one or many machines, by MPI. In a library of its own (cde::mpi), so that the
/// driver needs none.
namespace cde::mpi {

/// A piece of work, as rank 0 hands it out.
struct Chunk {
  std::uint64_t number = 0;
  std::string input;                  ///< at most 2^31 - 64 bytes, and so is a result
  std::optional<unsigned> rank = {};  ///< whose it is; none: whoever has time for it
};

/// Work that is dealt by demand: a rank that is slow gets less of it.
struct Work {
  /// On rank 0: the next piece; nothing: not now, as too many wait for one before them, or never.
  std::function<std::optional<Chunk>()> next;
  /// On rank 0: whether next() may still have one. Asked when all that were dealt are done.
  std::function<bool()> more;
  /// On every rank, rank 0 too: its result.
  std::function<std::string(const Chunk&)> run;
  /// On rank 0, in the order in which results come.
  std::function<void(std::uint64_t number, std::string result)> done;
};

/// The ranks that this process was started among. One in a process; MPI begins and ends with it.
class Ranks {
 public:
  /// Whether a launcher (mpirun, srun with PMI) started this process, by what it leaves in the
  /// environment.
  [[nodiscard]] static bool started() noexcept;

  /// Error kConfiguration if MPI cannot be used from a second thread.
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  [[nodiscard]] unsigned rank() const { return rank_; }
  [[nodiscard]] unsigned size() const { return size_; }
  /// Host of a rank, as that one names itself.
  [[nodiscard]] const std::string& host(unsigned rank) const { return hosts_.at(rank); }
  /// "rank 3 on node7".
  [[nodiscard]] std::string place(unsigned rank) const;

  // Called by all ranks, in the same order.

  /// Rank 0's bytes, on every rank.
  [[nodiscard]] std::string broadcast(std::string bytes) const;
  /// Rank 0's mesh, on every rank. Its `files` stay on rank 0.
  void broadcast(Mesh& mesh) const;
  /// Every rank gets what `of` makes on rank 0 for it, one after the other.
  [[nodiscard]] std::string scatter(const std::function<std::string(unsigned rank)>& of) const;
  /// Everybody's bytes by rank, on every rank.
  [[nodiscard]] std::vector<std::string> all_of(const std::string& bytes) const;

  /// Deals the work until there is no more. On rank 0 next(), more() and done() are called by a
  /// thread of their own, beside run(). What one of the functions throws ends the work on all
  /// ranks: rank 0 throws it, with the rank and host that it is from before it, the others an
  /// Error that says so. Waiting takes no processor time.
  void deal(const Work& work) const;

  /// Ends all ranks at once.
  [[noreturn]] void abort(int status) const;

 private:
  unsigned rank_ = 0, size_ = 1;
  std::vector<std::string> hosts_;
};

}  // namespace cde::mpi
