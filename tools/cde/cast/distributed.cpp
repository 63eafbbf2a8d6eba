// SPDX-License-Identifier: Apache-2.0
// cde cast in chunks: among ranks, as a shard, or with a journal.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <type_traits>

#include "cast/job.hpp"
#include "cast/parts.hpp"
#include "cde/contract/records.hpp"
#include "cde/model/model.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Tests of a chunk, about half a second of a core. That is long compared with distributing a chunk
/// and short compared with a run.
constexpr double kChunkTests = 3e7;
/// Packets of a chunk with a BVH: a ray takes some microseconds for any mesh.
constexpr std::size_t kChunkPackets = 128;

std::size_t rays_of_chunk(const CastTask& o, const CastJob& job) {
  if (job.config.traversal_units != 0) return card::kMostPrimaries * kChunkPackets;
  const double packets =
      kChunkTests / card::kMostPrimaries / (static_cast<double>(job.triangles) / o.partition);
  return card::kMostPrimaries * static_cast<std::size_t>(std::clamp(packets, 1.0, 256.0));
}

/// The data before a chunk's rays. A picture's shadows have a mode of their own. The number of rays
/// that are also checked by brute force depends on all rays of the run.
struct InputHead {
  std::uint64_t mode = 0, brute_force_rays = 0;
};

std::string bytes_of(Mode mode, std::uint64_t brute_force_rays, const RayView& rays) {
  const InputHead head{.mode = static_cast<std::uint64_t>(mode),
                       .brute_force_rays = brute_force_rays};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  bytes.reserve(sizeof head + rays.size() * sizeof(std::array<float, Ray::kWords>));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto words = to_words(rays[i]);
    bytes.append(reinterpret_cast<const char*>(words.data()), sizeof words);
  }
  return bytes;
}
InputHead head_of(const std::string& input) {
  InputHead head;
  std::memcpy(&head, input.data(), sizeof head);
  return head;
}
std::vector<Ray> rays_in(const std::string& input) {
  std::array<float, Ray::kWords> words{};
  std::vector<Ray> rays((input.size() - sizeof(InputHead)) / sizeof words);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    std::memcpy(words.data(), input.data() + sizeof(InputHead) + i * sizeof words, sizeof words);
    rays[i] = from_words<Ray>(std::span<const float, Ray::kWords>(words));
  }
  return rays;
}

/// How many rays before this one are also checked by brute force; these are spread evenly.
std::uint64_t brute_force_before(std::size_t ray, const CastTask& o, const CastJob& job) {
  if (!job.bvh || !o.check) return 0;
  return std::min<std::uint64_t>(o.brute_force_rays, job.rays.size()) * ray / job.rays.size();
}

/// The head of a chunk's result. The name of the simulation model and the records follow. Ranks and
/// journals must come from one build.
struct Head {
  Counters counters;
  std::uint64_t hits = 0, compared = 0, matching = 0, brute_force_rays = 0, upload_cycles = 0,
                config_hash = 0;
  double modelled_seconds = 0, simulation_seconds = 0;
  std::uint64_t model_bytes = 0, records = 0;
};
static_assert(std::is_trivially_copyable_v<Head>);
static_assert(std::is_standard_layout_v<Record>);

std::string as_bytes(const CastOutcome& r, std::span<const Record> records) {
  const Head head{.counters = r.counters,
                  .hits = r.hits,
                  .compared = r.compared,
                  .matching = r.matching,
                  .brute_force_rays = r.brute_force_rays,
                  .upload_cycles = r.upload_cycles,
                  .config_hash = r.config_hash,
                  .modelled_seconds = r.modelled_seconds,
                  .simulation_seconds = r.simulation_seconds,
                  .model_bytes = r.model.size(),
                  .records = records.size()};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  bytes.append(r.model);
  return bytes.append(reinterpret_cast<const char*>(records.data()), records.size_bytes());
}

/// The head of a chunk's result. Error kFile if its counts differ from the bytes behind it.
Head head_in(const std::string& bytes) {
  Head head;
  const auto fail = [](const std::string& why) { throw Error(ErrorCode::kFile, why); };
  if (bytes.size() < sizeof head)
    fail(fmt::format("it has {} bytes, its head alone has {}", bytes.size(), sizeof head));
  std::memcpy(&head, bytes.data(), sizeof head);
  const std::uint64_t rest = bytes.size() - sizeof head;
  if (head.model_bytes > rest || (rest - head.model_bytes) % sizeof(Record) != 0 ||
      (rest - head.model_bytes) / sizeof(Record) != head.records)
    fail(fmt::format("it states a name of {} bytes and {} records of {} bytes; {} bytes follow",
                     head.model_bytes, head.records, sizeof(Record), rest));
  return head;
}

/// Checks that a chunk's result is one of so many rays and triangles.
void check_outcome(const std::string& bytes, std::size_t rays, std::uint64_t triangles) {
  const Head head = head_in(bytes);
  const char* const records = bytes.data() + sizeof head + head.model_bytes;
  for (std::uint64_t i = 0; i < head.records; ++i) {
    Record r;
    std::memcpy(static_cast<void*>(&r), records + i * sizeof r, sizeof r);
    if (r.primary >= rays || (r.index != ~0u && r.index >= triangles))
      throw Error(ErrorCode::kFile,
                  fmt::format("its record {} has ray {} and triangle {}; it has {} rays and {} "
                              "triangles",
                              i, r.primary, r.index, rays, triangles));
  }
}

/// Reads a chunk's result. The numbers in its records count through all rays.
CastOutcome outcome_in(const std::string& bytes, std::size_t first, std::vector<Record>& records) {
  const Head head = head_in(bytes);
  CastOutcome r;
  r.counters = head.counters;
  r.hits = head.hits;
  r.compared = head.compared;
  r.matching = head.matching;
  r.brute_force_rays = head.brute_force_rays;
  r.upload_cycles = head.upload_cycles;
  r.config_hash = head.config_hash;
  r.modelled_seconds = head.modelled_seconds;
  r.simulation_seconds = head.simulation_seconds;
  r.model = bytes.substr(sizeof head, head.model_bytes);
  records.resize(head.records);
  std::memcpy(static_cast<void*>(records.data()), bytes.data() + sizeof head + head.model_bytes,
              records.size() * sizeof(Record));
  for (Record& record : records) record.primary += static_cast<std::uint32_t>(first);
  return r;
}

/// For modelled times: the network between the cards and the host with the outputs. Results come
/// over one link, one after the other.
constexpr double kBytesPerSecond = 1.25e9, kLatencySeconds = 50e-6;

/// The outcomes of all chunks as one. Without parts, each chunk goes to the card that would be free
/// first; with parts, to the card with its part. The modelled time ends when the last result has
/// arrived.
class Sum {
 public:
  Sum(unsigned cards, unsigned parts) : parts_(parts), free_at_(parts > 1 ? parts : cards, 0.0) {}

  void add(CastOutcome one, unsigned part) {
    const std::uint64_t records = all.counters.records, bad = all.counters.bad_primaries;
    all.counters += one.counters;
    all.counters.records = records;  // only records after the reduction count
    if (part != 0) all.counters.bad_primaries = bad;
    all.compared += one.compared;
    all.matching += one.matching;
    all.brute_force_rays += one.brute_force_rays;
    all.simulation_seconds += one.simulation_seconds;
    all.upload_cycles = std::max(all.upload_cycles, one.upload_cycles);
    all.model = std::move(one.model);
    all.config_hash = one.config_hash;
    double& card = parts_ > 1 ? free_at_[part] : *std::ranges::min_element(free_at_);
    card += one.modelled_seconds;
    all.modelled_seconds = card;
    if (free_at_.size() == 1) return;
    link_ = std::max(link_, card) +
            static_cast<double>(one.counters.records * sizeof(Record)) / kBytesPerSecond;
    all.modelled_seconds = link_ + kLatencySeconds;
  }
  void add(std::span<const Record> records) {
    all.counters.records += records.size();
    for (const Record& r : records) all.hits += r.f ? 1 : 0;
  }
  CastOutcome all;

 private:
  unsigned parts_;
  std::vector<double> free_at_;
  double link_ = 0;
};

/// The cards of parts, each with its job.
class Cards {
 public:
  Cards(const CastTask& o, const CastJob& job) : o_(o), job_(job) {}
  [[nodiscard]] const CastJob& job_of(unsigned part) const {
    return o_.partition == 1 ? job_ : *job_.parts.at(part);
  }
  Board& card_of_part(unsigned part) {
    const auto at = cards_.find(part);
    return at != cards_.end() ? at->second
                              : cards_.emplace(part, card_of(o_, job_of(part))).first->second;
  }

 private:
  const CastTask& o_;
  const CastJob& job_;
  std::map<unsigned, Board> cards_;
};

std::string contents(const Mesh& mesh) {
  const auto of = [](const auto& list) {
    return fingerprint({reinterpret_cast<const char*>(list.data()), list.size() * sizeof list[0]});
  };
  return of(mesh.vertices) + of(mesh.faces);
}

/// A part of the mesh as a job without rays.
std::shared_ptr<const CastJob> job_of_part(const CastJob& job, Mesh mesh) {
  auto part = std::make_shared<CastJob>();
  part->mesh = std::move(mesh);
  part->triangles = part->mesh.faces.size();
  part->mode = job.mode;
  part->config = job.config;
  return part;
}

/// Rank R of N gets the parts R, R + N, R + 2 N and so on.
void share_parts(const CastTask& o, CastJob& job) {
  const WorkDistributor& distributor = WorkDistributor::instance();
  const unsigned parts = o.partition, ranks = distributor.ranks();
  const std::string bytes = distributor.scattered([&](unsigned rank) {
    std::string all;
    for (unsigned p = rank; p < parts; p += ranks) {
      const std::uint64_t first = first_face_of(job.triangles, p, parts);
      append_mesh(part_of(job.mesh, first, first_face_of(job.triangles, p + 1, parts) - first),
                  all);
    }
    return all;
  });
  // Rank 0 needs the whole mesh for fields and pictures, which are computed from records and
  // triangles.
  if (o.fields.empty() && !o.picture.any()) job.mesh = Mesh{};
  std::size_t at = 0;
  for (unsigned p = distributor.rank(); p < parts; p += ranks)
    job.parts.emplace(p, job_of_part(job, mesh_at(bytes, at)));
}

}  // namespace

void share_job(const CastTask& o, CastJob& job) {
  const WorkDistributor& distributor = WorkDistributor::instance();
  job.config = distributor.shared(job.config);
  job.triangles = std::stoull(distributor.shared(std::to_string(job.triangles)));
  job.fingerprint =
      distributor.shared(fmt::format("{} {}", printable_name(job.mesh.name), contents(job.mesh)));
  if (o.partition > 1 && !distributor.merges())
    share_parts(o, job);
  else
    distributor.share(job.mesh);
  // Each rank builds the BVH: that is faster than sending it, and all get the same.
  if (job.config.traversal_units != 0 && !job.bvh)
    job.bvh = std::make_shared<const Bvh>(Bvh::build(job.mesh));
}

void check_distribution(const CastTask& o) {
  if (o.partition == 1 && !WorkDistributor::instance().is_chunked(o.distribution)) return;
  if (o.trace.wanted() || o.boards > 1)
    throw Error(ErrorCode::kUsage,
                fmt::format("{} works only in one process; it cannot be combined with ranks, "
                            "--partition, --resume or --shard",
                            o.boards > 1 ? "--boards" : "--trace"));
  if (o.picture.shadows && o.distribution.shard != "1/1")
    throw Error(ErrorCode::kUsage,
                "--shadows cannot be combined with --shard; shadows need all hits");
}

void begin_distribution(const CastTask& o, const CastJob& job) {
  WorkDistributor& distributor = WorkDistributor::instance();
  if (o.partition == 1 && !distributor.is_chunked(o.distribution)) return;
  Json run = {{"verb", o.verb},
              {"mode", cde::name_of(o.request.mode)},
              {"through", job.bvh ? "bvh" : "brute_force"},
              {"parameters", job.config.parameters()},
              {"checked", o.check},
              {"clock_hz", o.request.device.clock_hz()},
              {"partition", o.partition},
              {"triangles", job.triangles},
              {"mesh", job.fingerprint}};
  if (job.bvh && o.check) run["brute_force_rays"] = o.brute_force_rays;
  if (!distributor.merges())
    run["config_hash"] =
        fmt::format("{:016x}", model_hash(job.config.top(), job.config.parameters()));
  distributor.begin(o.distribution, run, o.quiet);
}

CastOutcome distribute_rays(const CastTask& o, const CastJob& job, const std::string& what,
                            const RecordSink& take) {
  const unsigned parts = o.partition, ranks = WorkDistributor::instance().ranks();
  const std::size_t rays = rays_of_chunk(o, job),
                    chunks = (job.rays.size() + rays - 1) / rays * parts;
  Cards cards(o, job);
  Sum sum(ranks, parts);
  std::vector<std::vector<Record>> of_parts(parts);
  std::vector<std::uint64_t> firsts;
  for (unsigned p = 0; p < parts; ++p) firsts.push_back(first_face_of(job.triangles, p, parts));
  Part part{.what = what, .chunks = chunks, .input = {}, .run = {}, .take = {}};
  part.input = [&](std::uint64_t c) -> std::optional<std::string> {
    if (c >= chunks) return std::nullopt;
    const std::size_t first = c / parts * rays;
    const RayView some = job.rays.subview(first, rays);
    return bytes_of(
        job.mode,
        brute_force_before(first + some.size(), o, job) - brute_force_before(first, o, job), some);
  };
  part.run = [&](std::uint64_t c, const std::string& input) {
    const auto p = static_cast<unsigned>(c % parts);
    const InputHead head = head_of(input);
    CastTask of_chunk = o;
    of_chunk.brute_force_rays = head.brute_force_rays;
    std::vector<Record> found;
    const CastOutcome one = cast_on(
        cards.card_of_part(p), of_chunk, cards.job_of(p), static_cast<Mode>(head.mode),
        rays_in(input), {},
        [&](std::span<const Record> some) { found.insert(found.end(), some.begin(), some.end()); });
    if (!one.difference.empty())
      throw Error(
          ErrorCode::kMismatch,
          fmt::format("in the chunk that begins with ray {}{}: {}", c / parts * rays,
                      parts == 1 ? "" : fmt::format(", part {} of the mesh", p), one.difference));
    return as_bytes(one, found);
  };
  part.check = [&](std::uint64_t c, const std::string& result) {
    const auto p = static_cast<unsigned>(c % parts);
    check_outcome(result, job.rays.subview(c / parts * rays, rays).size(),
                  first_face_of(job.triangles, p + 1, parts) - firsts[p]);
  };
  part.take = [&](std::uint64_t c, const std::string& result) {
    const auto p = static_cast<unsigned>(c % parts);
    sum.add(outcome_in(result, c / parts * rays, of_parts[p]), p);
    if (p + 1 < parts) return;
    const std::vector<Record> all =
        parts == 1 ? std::move(of_parts[0]) : reduced(job.mode, of_parts, firsts);
    sum.add(all);
    take(all);
  };
  if (parts > 1)
    part.owner = [&](std::uint64_t c) { return static_cast<unsigned>(c % parts) % ranks; };
  (void)WorkDistributor::instance().run_part(part);
  return sum.all;
}

}  // namespace cde::cli
