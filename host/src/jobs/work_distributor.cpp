// SPDX-License-Identifier: Apache-2.0
#include "cde/jobs/work_distributor.hpp"
#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <thread>
#include <tuple>

#include "cde/jobs/work_ranks.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/model/model.hpp"
#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"
#include "cde/support/progress.hpp"
#include "cde/support/version.hpp"

namespace cde {
namespace {

using Json = nlohmann::ordered_json;

/// Results per rank that may wait for an earlier one.
constexpr std::uint64_t kWindow = 16;

const std::vector<std::string> kDistributed = {"accuracy", "cast", "query", "render", "run"};

WorkDistributor* the_instance = nullptr;

std::string chunks_text(std::uint64_t count) {
  return fmt::format("{} chunk{}", count, count == 1 ? "" : "s");
}

}  // namespace

std::pair<unsigned, unsigned> parse_shard(const std::string& text) {
  unsigned shard = 0, shards = 0;
  int end = 0;
  if (std::sscanf(text.c_str(), "%6u/%6u%n", &shard, &shards, &end) != 2 ||
      static_cast<std::size_t>(end) != text.size() || shard < 1 || shard > shards)
    throw Error(
        ErrorCode::kUsage,
        fmt::format("--shard is {}; it must be I/N, part I of N, from 1/N to N/N, N at most "
                    "999999",
                    in_quotes(text)));
  return {shard, shards};
}

bool is_distributed(const std::string& verb) {
  return std::ranges::find(kDistributed, verb) != kDistributed.end();
}

/// The result of a chunk that a journal holds.
std::string stored(const Journal& journal, const Part& part, ChunkNumber key) {
  return journal.read(key, [&](const std::string& bytes) {
    if (part.check) part.check(key.chunk, bytes);
  });
}

/// Combines the fingerprints of a part's inputs, in their order, into one.
class Inputs {
 public:
  /// Adds an input and returns its own fingerprint.
  std::string add(const std::string& input) {
    std::string print = fingerprint(input);
    add_print(print);
    return print;
  }
  void add_print(const std::string& print) { all_ = fingerprint(all_ + print); }
  [[nodiscard]] Journal::PartEnd end(std::uint64_t chunks) const { return {chunks, all_}; }

 private:
  std::string all_;
};

/// Passes on the results of a part in their order, and keeps those that come early.
class WorkDistributor::Order {
 public:
  Order(const Part& part, bool quiet, std::optional<std::uint64_t> chunks)
      : part_(part), chunks_(chunks), bar_(part.what, quiet) {}

  void add(std::uint64_t chunk, std::string result) {
    waiting_.emplace(chunk, std::move(result));
    for (auto first = waiting_.begin(); first != waiting_.end() && first->first == taken_;
         first = waiting_.begin()) {
      const std::string next = std::move(first->second);
      waiting_.erase(first);
      part_.take(taken_++, next);
    }
    if (chunks_ && *chunks_ > 0) bar_(static_cast<double>(taken_) / static_cast<double>(*chunks_));
  }
  [[nodiscard]] std::uint64_t taken() const { return taken_; }

 private:
  const Part& part_;
  const std::optional<std::uint64_t> chunks_;  ///< number of the part's chunks, if it is known
  Progress bar_;
  std::uint64_t taken_ = 0;
  std::map<std::uint64_t, std::string> waiting_;
};

WorkDistributor::WorkDistributor() : ranks_(Ranks::if_started()) {
  the_instance = this;
  if (leads()) return;
  // Only rank 0 prints results.
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    ::close(nowhere);
  }
}

WorkDistributor::~WorkDistributor() {
  the_instance = nullptr;
}

WorkDistributor& WorkDistributor::instance() {
  return *the_instance;
}

unsigned WorkDistributor::rank() const {
  return ranks_ ? ranks_->rank() : 0;
}
unsigned WorkDistributor::ranks() const {
  return ranks_ ? ranks_->size() : 1;
}
std::string WorkDistributor::shared(std::string bytes) const {
  return ranks_ ? ranks_->broadcast(std::move(bytes)) : bytes;
}
void WorkDistributor::share(Mesh& mesh) const {
  if (ranks_) ranks_->broadcast(mesh);
}

std::string WorkDistributor::scattered(const std::function<std::string(unsigned)>& of) const {
  return ranks_ ? ranks_->scatter(of) : of(0);
}
BoardConfig WorkDistributor::shared(const BoardConfig& config) const {
  if (!ranks_) return config;
  const Json parameters = Json::parse(shared(json_text(Json(config.parameters()), -1)));
  return *BoardConfig::of(parameters.get<std::vector<std::string>>());
}

bool WorkDistributor::is_chunked(const DistributionOptions& options) const {
  return ranks() > 1 || !options.resume.empty() || !merged_.empty();
}

void WorkDistributor::begin(const DistributionOptions& options, Json run, bool quiet) {
  quiet_ = quiet;
  std::tie(shard_, shards_) = parse_shard(options.shard);
  Json all = {{"version", kVersion}, {"commit", kCommit}};
  all.update(run);
  if (ranks_) check_ranks(all);
  if (shards_ > 1 && ranks() > 1)
    throw Error(ErrorCode::kUsage, "--shard cannot be combined with the ranks of one run");
  config_hash_ = run.value("config_hash", std::string());
  if (!merged_.empty()) {
    config_hash_ = merged_.front()->run().value("config_hash", std::string());
    for (const auto& journal : merged_) journal->check_run(all);
    check_merged();
  }
  if (options.resume.empty() || !leads()) return;
  try {
    (void)Json(words_).dump();
  } catch (const Json::type_error&) {
    throw Error(ErrorCode::kUsage,
                "--resume stores the command line, which must be UTF-8; rename its files");
  }
  all["shard"] = options.shard;
  journal_ = std::make_unique<Journal>("--resume", options.resume, Journal::Use::kGoOn, all,
                                       Json{{"words", words_}});
  for (const auto& [number, place] : journal_->chunks()) (void)journal_->read(number);
}

/// Checks that all ranks agree with rank 0.
void WorkDistributor::check_ranks(const Json& run) const {
  const std::vector<std::string> all = ranks_->all_of(json_text(run, -1));
  const Json first = Json::parse(all[0]);
  for (unsigned rank = 1; rank < all.size(); ++rank) {
    const Json other = Json::parse(all[rank]);
    for (const auto& [key, value] : first.items()) {
      const Json there = other.contains(key) ? other.at(key) : Json();
      if (there == value) continue;
      throw Error(ErrorCode::kConfiguration,
                  fmt::format("{} has {} {}, {} has {}", ranks_->place(rank), key,
                              json_text(there, -1), ranks_->place(0), json_text(value, -1)));
    }
  }
}

bool WorkDistributor::run_part(const Part& part) {
  if (!merged_.empty()) return run_merged(part);
  if (shards_ > 1) return run_shard(part);
  run_all(part);
  return leads();
}

void WorkDistributor::run_all(const Part& part) {
  if (!leads()) {
    while (!ranks_->broadcast({}).empty())
      ranks_->distribute({.next = {}, .more = {}, .run = part.run, .done = {}});
    released_ = true;
    return;
  }
  Order order(part, quiet_, part.chunks);
  const std::uint64_t window = kWindow * ranks();
  Inputs all;
  std::map<std::uint64_t, std::string> inputs;  // fingerprints of the distributed inputs
  std::uint64_t number = 0;
  bool ended = false;
  const auto next = [&]() -> std::optional<RankChunk> {
    while (!ended && number - order.taken() < window) {
      std::optional<std::string> input = part.input(number);
      if (!input) {
        ended = true;
        if (journal_) journal_->end_part(parts_, all.end(number));
        break;
      }
      const ChunkNumber key{parts_, number};
      std::string print = journal_ ? all.add(*input) : std::string();
      if (journal_ && journal_->has(key)) {
        journal_->check_input(key, print);
        order.add(number++, stored(*journal_, part, key));
        continue;
      }
      inputs.emplace(number, std::move(print));
      const auto owner = part.owner ? std::optional(part.owner(number)) : std::nullopt;
      return RankChunk{number++, std::move(*input), owner};
    }
    return std::nullopt;
  };
  const auto done = [&](std::uint64_t chunk, std::string result) {
    const auto input = inputs.extract(chunk);
    if (journal_) journal_->add({parts_, chunk}, input.mapped(), result);
    order.add(chunk, std::move(result));
  };
  if (ranks_) {
    (void)ranks_->broadcast("part");
    ranks_->distribute(
        {.next = next, .more = [&] { return !ended; }, .run = part.run, .done = done});
  } else {
    while (const auto chunk = next()) done(chunk->number, part.run(chunk->number, chunk->input));
  }
  ++parts_;
}

/// Works on the chunks of this shard and writes them into the journal.
bool WorkDistributor::run_shard(const Part& part) {
  Progress bar(part.what, quiet_);
  Inputs all;
  std::uint64_t number = 0;
  for (; const auto input = part.input(number); ++number) {
    const std::string print = all.add(*input);
    if (part.chunks) bar(static_cast<double>(number) / static_cast<double>(*part.chunks));
    if (number % shards_ + 1 != shard_) continue;
    const ChunkNumber key{parts_, number};
    if (journal_->has(key))
      journal_->check_input(key, print);
    else
      journal_->add(key, print, part.run(number, *input));
  }
  journal_->end_part(parts_, all.end(number));
  ++parts_;
  return false;
}

bool WorkDistributor::run_merged(const Part& part) {
  const auto end = merged_.front()->end_of(parts_);
  const std::uint64_t chunks = end ? end->chunks : 0;
  Order order(part, quiet_, chunks);
  for (std::uint64_t number = 0; number < chunks; ++number) {
    const ChunkNumber key{parts_, number};
    const auto holder =
        std::ranges::find_if(merged_, [&](const auto& journal) { return journal->has(key); });
    if (part.inputs_again) {
      const auto input = part.input(number);
      (*holder)->check_input(key, input ? fingerprint(*input) : "none");
    }
    order.add(number, stored(**holder, part, key));
  }
  if (part.inputs_again && part.input(chunks))
    throw Error(ErrorCode::kUsage,
                fmt::format("cde merge: {} belongs to a run of {}; now there are more",
                            printable_name(merged_.front()->path()), chunks_text(chunks)));
  ++parts_;
  return true;
}

/// Checks that the journals hold every chunk of every part exactly once.
void WorkDistributor::check_merged() const {
  const auto name = [](const Journal& journal) { return printable_name(journal.path()); };
  std::map<ChunkNumber, const Journal*> from;
  for (const auto& journal : merged_) {
    for (const auto& [number, place] : journal->chunks()) {
      const auto [there, is_new] = from.emplace(number, journal.get());
      if (!is_new)
        throw Error(ErrorCode::kUsage,
                    fmt::format("cde merge: chunk {} is in {} and in {} (shards {} and {})",
                                number.chunk, name(*there->second), name(*journal),
                                there->second->run().value("shard", ""),
                                journal->run().value("shard", "")));
    }
  }
  const auto has_part = [this](unsigned p) {
    return std::ranges::any_of(merged_, [p](const auto& j) { return j->end_of(p).has_value(); });
  };
  for (unsigned p = 0; p == 0 || has_part(p); ++p) {
    check_ends(p);
    const std::uint64_t chunks = merged_.front()->end_of(p)->chunks;
    for (std::uint64_t number = 0; number < chunks; ++number) {
      if (from.contains({p, number})) continue;
      const auto shards = parse_shard(merged_.front()->run().value("shard", "1/1")).second;
      throw Error(
          ErrorCode::kUsage,
          fmt::format(
              "cde merge: chunk {} of {} is in no journal; the journal of shard {}/{} is missing",
              number, chunks, number % shards + 1, shards));
    }
    check_inputs(p, from);
  }
}

/// Checks that the chunks of a part, in their order, are those that its end states.
void WorkDistributor::check_inputs(unsigned part,
                                   const std::map<ChunkNumber, const Journal*>& from) const {
  const auto end = merged_.front()->end_of(part);
  Inputs inputs;
  for (std::uint64_t number = 0; number < end->chunks; ++number) {
    const ChunkNumber key{part, number};
    inputs.add_print(from.at(key)->chunks().at(key).input);
  }
  if (inputs.end(end->chunks) == *end) return;
  std::string names;
  for (const auto& journal : merged_)
    names += (names.empty() ? "" : ", ") + printable_name(journal->path());
  throw Error(ErrorCode::kFile,
              fmt::format("cde merge: {}: the inputs of the chunks of part {} are not those that "
                          "the part's end states: a chunk is missing or in another place",
                          names, part));
}

/// Checks that all journals have reached the end of the same part.
void WorkDistributor::check_ends(unsigned part) const {
  const auto name = [](const Journal& journal) { return printable_name(journal.path()); };
  const Journal& first = *merged_.front();
  for (const auto& journal : merged_) {
    const auto end = journal->end_of(part);
    if (!end)
      throw Error(ErrorCode::kUsage,
                  fmt::format("cde merge: {} (shard {}) is not finished; run its command again",
                              name(*journal), journal->run().value("shard", "1/1")));
    const auto other = first.end_of(part);
    if (*other == *end) continue;
    if (other->chunks != end->chunks)
      throw Error(
          ErrorCode::kUsage,
          fmt::format("cde merge: {} belongs to a run of {}, but {} to one of {}", name(first),
                      chunks_text(other->chunks), name(*journal), end->chunks));
    throw Error(ErrorCode::kUsage,
                fmt::format("cde merge: {} and {} belong to runs with different inputs",
                            name(first), name(*journal)));
  }
}

void WorkDistributor::add_inputs(std::vector<FileUse>& inputs) const {
  for (const auto& journal : merged_) inputs.push_back({"merge", journal->path()});
}

void WorkDistributor::start(const std::vector<std::string>& words) {
  words_ = words;
  if (ranks() == 1) return;
  check_words();
  if (words.empty()) return;
  if (!words[0].starts_with("-") && words[0] != "help" && !is_distributed(words[0]))
    throw Error(ErrorCode::kUsage, fmt::format("{} ranks were started, and each would do the same "
                                               "work; ranks can share the work of cde {}",
                                               ranks(), fmt::join(kDistributed, ", ")));
  if (std::getenv("CDE_WAVES") != nullptr)
    throw Error(ErrorCode::kUsage,
                "CDE_WAVES needs a single process: ranks would write the same files");
}

/// Checks that every rank got the same command line.
void WorkDistributor::check_words() const {
  const std::vector<std::string> all = ranks_->all_of(json_text(Json(words_), -1));
  const auto first = Json::parse(all[0]).get<std::vector<std::string>>();
  for (unsigned rank = 1; rank < all.size(); ++rank) {
    if (all[rank] == all[0]) continue;
    const auto other = Json::parse(all[rank]).get<std::vector<std::string>>();
    const auto at =
        static_cast<std::size_t>(std::ranges::mismatch(first, other).in1 - first.begin());
    const auto word = [at](const std::vector<std::string>& of) {
      return at < of.size() ? in_quotes(of[at]) : std::string("none");
    };
    throw Error(ErrorCode::kConfiguration,
                fmt::format("{} has word {} {}, {} has {}", ranks_->place(rank), at + 1,
                            word(other), ranks_->place(0), word(first)));
  }
}

void WorkDistributor::end() {
  if (journal_ && shards_ > 1 && journal_->lost())
    throw Error(ErrorCode::kFile,
                fmt::format("shard {}/{} has no result: its journal {} was removed or replaced",
                            shard_, shards_, printable_name(journal_->path())));
  if (journal_ && shards_ > 1 && !quiet_)
    log(fmt::format("cde: shard {}/{} is complete: {} in {}; cde merge combines the shards\n",
                    shard_, shards_, chunks_text(journal_->size()),
                    printable_name(journal_->path())));
  if (ranks_ && !released_) (void)ranks_->broadcast({});  // for a verb that distributes no work
}

std::string WorkDistributor::place() const {
  if (leads()) return {};
  std::this_thread::sleep_for(std::chrono::seconds(3));
  return ranks_->place(rank()) + ": ";
}

void WorkDistributor::fail(int status) {
  if (ranks_ && ranks_->size() > 1) ranks_->abort(status);
}

}  // namespace cde
