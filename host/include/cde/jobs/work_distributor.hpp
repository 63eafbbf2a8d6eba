// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cde/jobs/journal.hpp"
#include "cde/support/output_file.hpp"

namespace cde {
struct Mesh;
struct BoardConfig;
}  // namespace cde

/// @file
/// Runs that are cut into chunks, so that they can be distributed and resumed.
namespace cde {

/// Options of a verb for its distribution.
struct DistributionOptions {
  std::string resume;         ///< file of finished chunks; empty: none
  std::string shard = "1/1";  ///< I/N: shard I of N independent processes
};

/// A part of a run. Chunks are numbered from 0.
struct Part {
  std::string what;                     ///< name for the progress line
  std::optional<std::uint64_t> chunks;  ///< number of chunks, if known in advance
  /// Input of a chunk; nothing after the last one. Called once per chunk, in order.
  std::function<std::optional<std::string>(std::uint64_t)> input;
  /// Whether a merge also computes the inputs, to compare them with the inputs of the shards.
  bool inputs_again = true;
  /// Result of a chunk. It depends on the input alone; any rank may compute it.
  std::function<std::string(std::uint64_t, const std::string& input)> run;
  /// Error if the bytes are not a result of this chunk. Asked for results that a journal holds,
  /// before `take`.
  std::function<void(std::uint64_t, const std::string& result)> check = {};
  /// The rank that must run a chunk because only it has the data; none: any rank.
  std::function<unsigned(std::uint64_t)> owner = {};
  /// Receives the results in order. Never at the same time as `input`, possibly at the same time as
  /// `run`.
  std::function<void(std::uint64_t, const std::string& result)> take;
};

/// How this process runs the chunks of its run: alone, among MPI ranks, as a shard, or by merging
/// journals. main() makes the only instance.
class WorkDistributor {
 public:
  WorkDistributor();
  ~WorkDistributor();
  WorkDistributor(const WorkDistributor&) = delete;
  WorkDistributor& operator=(const WorkDistributor&) = delete;
  [[nodiscard]] static WorkDistributor& instance();
  class Ranks;

  /// Sets the words of the command, for journals. Error kUsage if several ranks would each do the
  /// same work.
  void start(const std::vector<std::string>& words);
  /// Takes all chunks of the run from these journals.
  void merge(std::vector<std::unique_ptr<Journal>> journals) { merged_ = std::move(journals); }
  /// Appends those journals, for check_outputs().
  void add_inputs(std::vector<FileUse>& inputs) const;

  [[nodiscard]] unsigned rank() const;
  [[nodiscard]] unsigned ranks() const;
  /// Whether this process reads inputs and writes outputs: rank 0, or the only process.
  [[nodiscard]] bool leads() const { return rank() == 0; }
  [[nodiscard]] bool merges() const { return !merged_.empty(); }
  [[nodiscard]] bool is_shard() const { return shards_ > 1; }
  /// Bytes of rank 0, on all ranks.
  [[nodiscard]] std::string shared(std::string bytes) const;
  void share(Mesh& mesh) const;
  /// Each rank gets the bytes that `of` makes for it on rank 0.
  [[nodiscard]] std::string scattered(const std::function<std::string(unsigned rank)>& of) const;
  /// Configuration of rank 0, on all ranks: machines may have built others.
  [[nodiscard]] BoardConfig shared(const BoardConfig& config) const;

  /// Begins the run, before the first part. `run` holds, key by key, everything else that results
  /// depend on besides inputs. Ranks and journals that differ in a key are refused by its name
  /// (error kUsage or kConfiguration).
  void begin(const DistributionOptions& options, nlohmann::ordered_json run, bool quiet);
  /// Whether the work is distributed, resumed or merged. If not, the verb need not cut it into
  /// chunks.
  [[nodiscard]] bool is_chunked(const DistributionOptions& options) const;

  /// Runs a part. False if its results are not all here: a shard only stores them. On ranks other
  /// than 0: takes part in all parts until rank 0 has no more, then returns false.
  bool run_part(const Part& part);

  /// "config_hash" of the run, or of the merged runs.
  [[nodiscard]] std::string config_hash() const { return config_hash_; }

  /// After the last part: releases the other ranks.
  void end();
  /// Prefix of an error message: on ranks other than 0 the rank and host, otherwise empty. There it
  /// first waits, so that rank 0 can end all ranks if it reports the same error.
  [[nodiscard]] std::string place() const;
  /// Ends all ranks after an error.
  void fail(int status);

 private:
  class Order;
  void check_words() const;
  void check_ranks(const nlohmann::ordered_json& run) const;
  void check_merged() const;
  void check_ends(unsigned part) const;
  void check_inputs(unsigned part, const std::map<ChunkNumber, const Journal*>& from) const;
  bool run_merged(const Part& part);
  bool run_shard(const Part& part);
  void run_all(const Part& part);

  std::vector<std::string> words_;
  std::unique_ptr<Ranks> ranks_;  ///< null: this process is alone
  std::unique_ptr<Journal> journal_;
  std::vector<std::unique_ptr<Journal>> merged_;
  unsigned shard_ = 1, shards_ = 1;
  unsigned parts_ = 0;     ///< parts so far
  bool released_ = false;  ///< on ranks other than 0: rank 0 has no more parts
  std::string config_hash_;
  bool quiet_ = false;
};

/// Whether a verb distributes its work.
[[nodiscard]] bool is_distributed(const std::string& verb);

/// Value of --shard. Error kUsage.
[[nodiscard]] std::pair<unsigned, unsigned> parse_shard(const std::string& text);

}  // namespace cde
