// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdlib>

#include "cde/jobs/mpi_ranks.hpp"
#include "cde/jobs/work_ranks.hpp"

namespace cde {
namespace {

class MpiRanks final : public WorkDistributor::Ranks {
 public:
  [[nodiscard]] unsigned rank() const override { return ranks_.rank(); }
  [[nodiscard]] unsigned size() const override { return ranks_.size(); }
  [[nodiscard]] std::string place(unsigned rank) const override { return ranks_.place(rank); }
  [[nodiscard]] std::string broadcast(std::string bytes) const override {
    return ranks_.broadcast(std::move(bytes));
  }
  void broadcast(Mesh& mesh) const override { ranks_.broadcast(mesh); }
  [[nodiscard]] std::string scatter(const std::function<std::string(unsigned)>& of) const override {
    return ranks_.scatter(of);
  }
  [[nodiscard]] std::vector<std::string> all_of(const std::string& bytes) const override {
    return ranks_.all_of(bytes);
  }
  void distribute(const RankWork& work) const override {
    ranks_.distribute(
        {.next = [&]() -> std::optional<mpi::Chunk> {
           auto chunk = work.next();
           if (!chunk) return std::nullopt;
           return mpi::Chunk{chunk->number, std::move(chunk->input), chunk->rank};
         },
         .more = work.more,
         .run = [&](const mpi::Chunk& chunk) { return work.run(chunk.number, chunk.input); },
         .done = work.done});
  }
  [[noreturn]] void abort(int status) const override { ranks_.abort(status); }

 private:
  mpi::Ranks ranks_;
};

}  // namespace

std::unique_ptr<WorkDistributor::Ranks> WorkDistributor::Ranks::if_started() {
  if (!mpi::Ranks::started()) return nullptr;
  return std::make_unique<MpiRanks>();
}

}  // namespace cde
