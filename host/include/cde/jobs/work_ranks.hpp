// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cde/jobs/work_distributor.hpp"

namespace cde {

struct RankChunk {
  std::uint64_t number = 0;
  std::string input;
  std::optional<unsigned> rank = {};  ///< rank that must run it; none: any
};

/// cde::mpi::Work without MPI.
struct RankWork {
  std::function<std::optional<RankChunk>()> next;
  std::function<bool()> more;
  std::function<std::string(std::uint64_t, const std::string&)> run;
  std::function<void(std::uint64_t, std::string)> done;
};

/// cde::mpi::Ranks. A command built without MPI has no implementation of it.
class WorkDistributor::Ranks {
 public:
  /// Null unless a launcher started this process as one of several. Error kConfiguration if a
  /// launcher did and MPI was not built in.
  [[nodiscard]] static std::unique_ptr<Ranks> if_started();
  virtual ~Ranks() = default;
  [[nodiscard]] virtual unsigned rank() const = 0;
  [[nodiscard]] virtual unsigned size() const = 0;
  [[nodiscard]] virtual std::string place(unsigned rank) const = 0;
  [[nodiscard]] virtual std::string broadcast(std::string bytes) const = 0;
  virtual void broadcast(Mesh& mesh) const = 0;
  [[nodiscard]] virtual std::string scatter(
      const std::function<std::string(unsigned)>& of) const = 0;
  [[nodiscard]] virtual std::vector<std::string> all_of(const std::string& bytes) const = 0;
  virtual void distribute(const RankWork& work) const = 0;
  [[noreturn]] virtual void abort(int status) const = 0;
};

}  // namespace cde
