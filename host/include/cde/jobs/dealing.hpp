// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
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

/// Runs that are cut into chunks, so that they can be shared out and go on where they ended.
namespace cde {

/// What a verb was asked of it.
struct DealOptions {
  std::string resume;         ///< file of finished chunks; empty: none
  std::string shard = "1/1";  ///< I/N: of N processes that know nothing of each other, the Ith
};

/// A part of a run. Chunks are numbered from 0.
struct Part {
  std::string what;                     ///< the progress says
  std::optional<std::uint64_t> chunks;  ///< how many, if that is known before
  /// What a chunk is made of; nothing behind the last one. Called once each, in order.
  std::function<std::optional<std::string>(std::uint64_t)> input;
  /// Whether merging has the inputs, too, which are compared then with those of the shards.
  bool inputs_again = true;
  /// Its result, which depends on the input alone. On whichever rank.
  std::function<std::string(std::uint64_t, const std::string& input)> run;
  /// The rank that a chunk is of, as only that one has what it needs; none: any.
  std::function<unsigned(std::uint64_t)> owner = {};
  /// Takes the results, in order. Not at the same time as `input`, but perhaps as `run`.
  std::function<void(std::uint64_t, const std::string& result)> take;
};

/// How this process deals the chunks of its run: among the ranks that it was started with, as a
/// shard, from the journals of others, or by itself. There is one, which main() makes.
class Dealing {
 public:
  Dealing();
  ~Dealing();
  Dealing(const Dealing&) = delete;
  Dealing& operator=(const Dealing&) = delete;
  [[nodiscard]] static Dealing& here();
  class Ranks;

  /// The command's words, for journals. Error kUsage if several ranks would do the same.
  void start(const std::vector<std::string>& words);
  /// The chunks of the run come from these, all of them.
  void merge(std::vector<std::unique_ptr<Journal>> journals) { merged_ = std::move(journals); }
  /// Those journals, for check_outputs().
  void add_inputs(std::vector<FileUse>& inputs) const;

  [[nodiscard]] unsigned rank() const;
  [[nodiscard]] unsigned ranks() const;
  /// This process reads inputs and writes outputs: rank 0, or the only one.
  [[nodiscard]] bool leads() const { return rank() == 0; }
  [[nodiscard]] bool merges() const { return !merged_.empty(); }
  [[nodiscard]] bool is_shard() const { return shards_ > 1; }
  /// What rank 0 has, on all ranks.
  [[nodiscard]] std::string shared(std::string bytes) const;
  void share(Mesh& mesh) const;
  /// Every rank gets what `of` makes on rank 0 for it.
  [[nodiscard]] std::string scattered(const std::function<std::string(unsigned rank)>& of) const;
  /// Rank 0's card, on all ranks: machines may have others built.
  [[nodiscard]] BoardConfig shared(const BoardConfig& config) const;

  /// What is done, before the first part. `run` is what results depend on besides inputs, key by
  /// key: ranks and journals that differ in it are refused by name (Error kUsage, kConfiguration).
  void begin(const DealOptions& options, nlohmann::ordered_json run, bool quiet);
  /// Whether anything but the plain run was asked: else the verb need not cut it up.
  [[nodiscard]] bool asked(const DealOptions& options) const;

  /// Deals a part; false if its results are not all here, as this is a shard, which only keeps
  /// them. On other ranks than 0: takes part in all parts until rank 0 has no more, and is false.
  bool deal(const Part& part);

  /// "config_hash" of what the run began with, or of the runs that are merged.
  [[nodiscard]] std::string config_hash() const { return config_hash_; }

  /// Behind the last part: lets other ranks go.
  void end();
  /// What an error's message begins with: on other ranks than 0 where it is from, after a while in
  /// which rank 0, if it has the same to say, has ended them all.
  [[nodiscard]] std::string place() const;
  /// Ends all ranks after an error.
  void fail(int status);

 private:
  class Order;
  void check_words() const;
  void check_ranks(const nlohmann::ordered_json& run) const;
  void check_merged() const;
  void check_ends(unsigned part) const;
  bool deal_merged(const Part& part);
  bool deal_shard(const Part& part);
  void deal_all(const Part& part);

  std::vector<std::string> words_;
  std::unique_ptr<Ranks> among_;  ///< null: this process is alone
  std::unique_ptr<Journal> journal_;
  std::vector<std::unique_ptr<Journal>> merged_;
  unsigned shard_ = 1, shards_ = 1;
  unsigned parts_ = 0;     ///< so far
  bool released_ = false;  ///< another rank than 0 has heard that there are no more
  std::string config_hash_;
  bool quiet_ = false;
};

/// Whether a verb deals its work.
[[nodiscard]] bool is_dealt(const std::string& verb);

/// --shard's value. Error kUsage.
[[nodiscard]] std::pair<unsigned, unsigned> parse_shard(const std::string& text);

}  // namespace cde
