// SPDX-License-Identifier: Apache-2.0
#include "report/report.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cde/support/counted.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

constexpr std::size_t kMostHits = 4'096;           // per query and frame of the view
constexpr std::size_t kMostApart = 64;             // closest pairs that miss, per query and frame
constexpr std::size_t kMostViewBytes = 4'000'000;  // for all frames of the view

/// Names used in pages/report.js, in the order of Drawn.
constexpr std::array kDrawnNames = {"rays", "surface", "sphere", "box", "plane", "cylinder"};
static_assert(kDrawnNames.size() == static_cast<std::size_t>(Drawn::kCylinder) + 1);

/// sRGB colour of an object: one for rays, others in turn for surfaces and solids.
std::string_view colour_of(Drawn drawn, std::size_t number) {
  constexpr std::array<std::string_view, 4> kColours = {"#9aa9b8", "#c2a57e", "#86b39b", "#ab97bd"};
  return drawn == Drawn::kRays ? "#6f9bd1" : kColours[number % kColours.size()];
}

Colour linear(std::string_view hex) {
  Colour colour{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float x =
        static_cast<float>(std::stoi(std::string(hex.substr(1 + 2 * k, 2)), nullptr, 16)) / 255;
    colour[k] = x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
  }
  return colour;
}

void append(std::vector<float>& to, const Eigen::Vector3f& v) {
  to.insert(to.end(), {v.x(), v.y(), v.z()});
}

/// For unit shapes: the matrix row by row, then the translation. For balls: centre and radius.
std::string placements_text(const std::vector<Placement>& placements, Drawn drawn) {
  std::vector<float> words;
  for (const Placement& p : placements) {
    if (drawn == Drawn::kBall) {
      append(words, p.t), words.push_back(p.m(0, 0));
      continue;
    }
    for (int row = 0; row < 3; ++row) append(words, p.m.row(row));
    append(words, p.t);
  }
  return base64_of(words);
}

nlohmann::ordered_json hits_json(const std::vector<ShownHit>& hits, bool normals) {
  std::vector<float> words;
  std::vector<std::uint32_t> numbers;
  for (const ShownHit& h : hits) {
    append(words, h.cp), words.push_back(h.t);
    if (normals) append(words, h.n);
    numbers.insert(numbers.end(), {h.primary, h.index});
  }
  return {{"words", base64_of(words)}, {"numbers", base64_of(numbers)}};
}

/// A plane, cut to the size of the scene and centred in it.
Placement fitted(const Placement& plane, const Eigen::AlignedBox3f& box) {
  const Eigen::Vector3f n = plane.m.col(2), c = box.center();
  return {0.5f * box.diagonal().norm() * plane.m, c - n * n.dot(c - plane.t)};
}

}  // namespace

Report::Report(const Scene& scene) : scene_(scene), geometry_(scene), kept_(scene.queries.size()) {}

std::size_t Report::stride_of_primaries(const SceneQuery& query) const {
  std::size_t stride = 1;
  for (const std::size_t i : query.primaries)
    stride = std::max(stride, geometry_.objects()[i].stride);
  return stride;
}

bool Report::keeps(const SceneQuery& query, const Record& record) const {
  return record.f && record.primary % stride_of_primaries(query) == 0;
}

void Report::measure(const SceneQuery& query, const Record& r, Kept& kept) const {
  const bool solid = is_solid(query.pair);
  if (r.bad || !std::isfinite(r.t) || (!r.f && !solid)) return;
  const float signed_t = solid && r.f ? -r.t : r.t;
  kept.least = std::fmin(kept.least, signed_t), kept.most = std::fmax(kept.most, signed_t);
  if (r.f || !query.normals) return;
  const auto nearer = [](const ShownHit& a, const ShownHit& b) { return a.t < b.t; };
  kept.apart.push_back({r.primary, r.index, r.t, r.cp, r.n});
  std::push_heap(kept.apart.begin(), kept.apart.end(), nearer);
  if (kept.apart.size() <= kMostApart) return;
  std::pop_heap(kept.apart.begin(), kept.apart.end(), nearer);
  kept.apart.pop_back();
}

void Report::records(std::size_t number, std::span<const Record> records) {
  const SceneQuery& query = scene_.queries[number];
  Kept& kept = kept_[number];
  for (const Record& r : records) {
    if (r.primary == r.index && query.primaries == query.secondaries) {
      with_itself_ = with_itself_ || keeps(query, r);
      continue;
    }
    measure(query, r, kept);
    if (!keeps(query, r)) continue;
    if (kept.hits.size() < kMostHits)
      kept.hits.push_back({r.primary, r.index, r.t, r.cp, query.normals ? r.n : r.n.Zero()});
    else
      ++kept.left_out;
  }
}

void Report::frame(std::uint32_t number, const std::vector<QueryFrame>& answers) {
  FrameResult result;
  result.number = number;
  for (std::size_t q = 0; q < answers.size(); ++q) {
    result.modelled += time_split(answers[q], scene_.card.device.clock_hz());
    result.card_seconds += answers[q].pass_seconds;
    result.reference_seconds += answers[q].check_seconds;
    result.records += answers[q].counters.records;
    result.hits += answers[q].hits;
    result.distances.push_back({kept_[q].least, kept_[q].most});
  }
  frame_results_.push_back(result);
  if ((frame_results_.size() - 1) % stride_ == 0) {
    std::vector<ShownObject> shown;
    for (std::size_t i = 0; i < scene_.objects.size(); ++i)
      shown.push_back(geometry_.show(i, number));
    look(number, shown);
  }
  for (Kept& kept : kept_) {
    hits_left_out_ += kept.left_out;
    kept = {};
  }
}

std::vector<std::vector<float>> Report::last_hits() const {
  std::vector<std::vector<float>> last(scene_.objects.size());
  for (std::size_t i = 0; i < last.size(); ++i) last[i].assign(geometry_.objects()[i].count, NAN);
  for (std::size_t q = 0; q < kept_.size(); ++q) {
    const SceneQuery& query = scene_.queries[q];
    for (const bool primary : {true, false}) {
      const auto& side = primary ? query.primaries : query.secondaries;
      if (geometry_.objects()[side.front()].drawn != Drawn::kRays) continue;
      for (const ShownHit& h : kept_[q].hits) {
        std::size_t ray = primary ? h.primary : h.index, object = 0;
        while (object + 1 < side.size() && ray >= last[side[object]].size())
          ray -= last[side[object++]].size();
        float& t = last[side[object]].at(ray);
        t = std::isnan(t) ? h.t : std::max(t, h.t);
      }
    }
  }
  return last;
}

Eigen::Vector3f Report::ray_end(const Ray& ray, float t) const {
  if (std::isfinite(t)) return ray.o + t * ray.d;
  const float stub = 0.08f * box_.diagonal().norm() / ray.d.norm();
  return ray.o + std::min(ray.tmax, stub) * ray.d;
}

void Report::frame_scene(const std::vector<ShownObject>& shown) {
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const ShownObject& s = shown[i];
    const auto& object = geometry_.objects()[i];
    for (const Eigen::Vector3f& p : s.points) box_.extend(p);
    if (s.pose) {
      for (const Eigen::Vector3f& p : object.surface.points)
        box_.extend(s.pose->rotation * p + s.pose->translation);
    }
    for (const Placement& p : s.placements) {
      if (object.drawn == Drawn::kPlane) continue;
      const Eigen::Vector3f half = p.m.cwiseAbs().rowwise().sum();
      box_.extend(p.t - half), box_.extend(p.t + half);
    }
    for (const Ray& ray : s.rays) box_.extend(ray.o);
  }
  const Eigen::Vector3f one = Eigen::Vector3f::Ones();
  if (box_.isEmpty()) box_ = Eigen::AlignedBox3f(-one, one);
  const Eigen::Vector3f margin = 1e-3f * std::max(box_.diagonal().norm(), 1e-3f) * one;
  box_ = Eigen::AlignedBox3f(box_.min() - margin, box_.max() + margin);
  camera_ = camera_for(box_, kPictureSize);
}

void Report::look(std::uint32_t number, const std::vector<ShownObject>& shown) {
  if (!picture_) frame_scene(shown);
  const auto last = last_hits();
  if (!picture_) draw(shown, last);
  View view{{{"frame", number},
             {"seconds", seconds(scene_, number)},
             {"objects", Json::array()},
             {"queries", Json::array()}}};
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const auto& object = geometry_.objects()[i];
    const bool again =
        !views_.empty() && object.still && object.drawn != Drawn::kRays && !object.deforms;
    view.json["objects"].push_back(again ? Json() : object_json(i, shown[i], last[i]));
  }
  for (std::size_t q = 0; q < kept_.size(); ++q) {
    view.json["queries"].push_back(hits_json(kept_[q].hits, scene_.queries[q].normals));
    view.json["queries"].back()["apart"] = hits_json(kept_[q].apart, true)["words"];
  }
  view.bytes = json_text(view.json, -1).size();
  view_bytes_ += view.bytes;
  views_.push_back(std::move(view));
  if (view_bytes_ > kMostViewBytes && views_.size() > 1) thin_out();
}

void Report::thin_out() {
  stride_ *= 2;
  std::vector<View> half;
  view_bytes_ = 0;
  for (std::size_t i = 0; i < views_.size(); i += 2) {
    view_bytes_ += views_[i].bytes;
    half.push_back(std::move(views_[i]));
  }
  views_ = std::move(half);
}

/// In the first view all points. In other views the range from the first to the last point that has
/// moved since the first view.
Report::Json Report::points_json(std::size_t number, const std::vector<Eigen::Vector3f>& points) {
  first_points_.resize(scene_.objects.size());
  std::vector<Eigen::Vector3f>& before = first_points_[number];
  std::size_t from = 0, to = points.size();
  if (before.empty()) {
    before = points;
  } else {
    while (from < to && points[from] == before[from]) ++from;
    while (to > from && points[to - 1] == before[to - 1]) --to;
  }
  std::vector<float> words;
  for (std::size_t i = from; i < to; ++i) append(words, points[i]);
  return {{"from", from}, {"points", base64_of(words)}};
}

Report::Json Report::object_json(std::size_t number, const ShownObject& shown,
                                 const std::vector<float>& last) {
  const auto& object = geometry_.objects()[number];
  if (shown.pose) {
    Json words = Json::array();
    for (const float w : to_words(*shown.pose)) words.push_back(w);
    return {{"pose", words}};
  }
  if (object.drawn == Drawn::kSurface) return points_json(number, shown.points);
  if (object.drawn == Drawn::kRays) {
    std::vector<float> words;
    for (std::size_t i = 0; i < shown.rays.size(); ++i) {
      const float t = last[i * object.stride];
      append(words, shown.rays[i].o);
      append(words, ray_end(shown.rays[i], t));
      words.push_back(std::isfinite(t) ? 1 : 0);
    }
    return {{"rays", base64_of(words)}};
  }
  std::vector<Placement> placements = shown.placements;
  if (object.drawn == Drawn::kPlane) {
    for (Placement& p : placements) p = fitted(p, box_);
  }
  return {{"placements", placements_text(placements, object.drawn)}};
}

void Report::draw(const std::vector<ShownObject>& shown,
                  const std::vector<std::vector<float>>& last) {
  Picture picture(camera_, kPictureSize);
  const Colour hit = linear("#ffb454"), dot = linear("#ff6a4d"), contact = linear("#5fe0b0");
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const auto& object = geometry_.objects()[i];
    const Colour colour = linear(colour_of(object.drawn, i));
    Surface surface = object.surface;
    if (!shown[i].points.empty()) surface.points = shown[i].points;
    if (!surface.corners.empty())
      picture.surface(surface, shown[i].pose.value_or(Transform{}), colour);
    const Surface unit = unit_surface(object.drawn);
    for (const Placement& p : shown[i].placements) {
      const Placement q = object.drawn == Drawn::kPlane ? fitted(p, box_) : p;
      Surface solid = unit;
      for (Eigen::Vector3f& point : solid.points) point = q.m * point + q.t;
      picture.surface(solid, {}, colour);
    }
  }
  for (std::size_t i = 0; i < shown.size(); ++i) {
    for (std::size_t k = 0; k < shown[i].rays.size(); ++k) {
      const Ray& ray = shown[i].rays[k];
      const float t = last[i][k * geometry_.objects()[i].stride];
      const bool meets = std::isfinite(t);
      picture.line(ray.o, ray_end(ray, t), meets ? hit : linear("#6f9bd1"), meets ? 0.9f : 0.5f);
    }
  }
  for (std::size_t q = 0; q < kept_.size(); ++q) {
    const bool rays = !is_solid(scene_.queries[q].pair);
    for (const ShownHit& h : kept_[q].apart) {
      const Eigen::Vector3f half = 0.5f * h.t * h.n;
      picture.line(h.cp - half, h.cp + half, linear("#e9edf2"), 0.9f);
    }
    for (const ShownHit& h : kept_[q].hits) picture.dot(h.cp, rays ? dot : contact, 2.2f);
  }
  picture_ = png_bytes(picture.image());
}

Report::Json Report::data(const Json& run) const {
  Json j = {{"clock_hz", run.at("clock_hz")},
            {"parts", kTimeParts},
            {"frame_results", Json::array()},
            {"interval", static_cast<double>(stride_) / scene_.rate},
            {"camera", {{"fov", camera_.fov_degrees}}},
            {"objects", Json::array()},
            {"queries", Json::array()},
            {"views", Json::array()}};
  for (const FrameResult& p : frame_results_) {
    j["frame_results"].push_back({{"frame", p.number},
                                  {"records", p.records},
                                  {"hits", p.hits},
                                  {"modelled_seconds", parts(p.modelled)},
                                  {"card_wall_seconds", p.card_seconds},
                                  {"reference_wall_seconds", p.reference_seconds}});
  }
  const auto vector = [](const Eigen::Vector3f& v) { return Json{v.x(), v.y(), v.z()}; };
  if (!views_.empty()) {
    j["camera"]["eye"] = vector(camera_.eye), j["camera"]["target"] = vector(camera_.target);
    j["box"] = {vector(box_.min()), vector(box_.max())};
  }
  for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
    const auto& object = geometry_.objects()[i];
    Json o = {{"name", object.name},
              {"kind", kDrawnNames.at(static_cast<std::size_t>(object.drawn))},
              {"count", object.count},
              {"colour", colour_of(object.drawn, i)}};
    if (object.drawn == Drawn::kSurface) {
      const Surface& s = object.surface;
      std::vector<float> words;
      for (const Eigen::Vector3f& p : s.points) append(words, p);
      if (!object.deforms) o["points"] = base64_of(words);
      const bool small = s.points.size() <= 65'536;
      o["corner_bits"] = small ? 16 : 32;
      o["corners"] = small
                         ? base64_of(std::vector<std::uint16_t>(s.corners.begin(), s.corners.end()))
                         : base64_of(s.corners);
    }
    j["objects"].push_back(std::move(o));
  }
  for (const SceneQuery& q : scene_.queries) {
    j["queries"].push_back({{"name", q.name},
                            {"pair", name(q.pair)},
                            {"rays", !is_solid(q.pair)},
                            {"normals", q.normals}});
  }
  for (const View& view : views_) j["views"].push_back(view.json);
  return j;
}

std::string Report::legend_html() const {
  std::string html = "<ul class=\"legend\" id=\"objects\">\n";
  for (std::size_t i = 0; i < geometry_.objects().size(); ++i) {
    const auto& object = geometry_.objects()[i];
    html += fmt::format(
        "<li><svg width=\"14\" height=\"12\" aria-hidden=\"true\"><rect width=\"14\" height=\"12\" "
        "fill=\"{}\"/></svg>{}</li>\n",
        colour_of(object.drawn, i),
        escaped(
            fmt::format("{}, {} × {}", object.name, grouped(object.count), name(object.shape))));
  }
  return html + "</ul>\n";
}

std::vector<std::string> Report::notes() const {
  std::vector<std::string> notes = geometry_.notes();
  if (stride_ > 1)
    notes.push_back(
        fmt::format("The view has every {}th frame, {} of {}, to keep the page small; the charts "
                    "have all frames.",
                    stride_, views_.size(), frame_results_.size()));
  if (hits_left_out_ > 0)
    notes.push_back(
        fmt::format("{} hits beyond {} per query and frame are not drawn; run.json and the records "
                    "beside it have all.",
                    hits_left_out_, kMostHits));
  if (with_itself_)
    notes.emplace_back(
        "In a query of objects against themselves, the hit of each object with itself is not "
        "drawn.");
  return notes;
}

namespace {

/// A sentence for a run that a wrong record or an error ended.
std::string ended_early(const nlohmann::ordered_json& run) {
  if (run["finished"]) return "";
  const std::uint64_t all =
      run["frames"][1].get<std::uint64_t>() - run["frames"][0].get<std::uint64_t>() + 1;
  return fmt::format(" The run ended early, after {} of {}.", run["frame_results"].size(),
                     counted(all, "frame"));
}

}  // namespace

std::string Report::html(const Json& run) const {
  const std::string file = std::filesystem::path(scene_.file).filename();
  const std::string title = scene_.title.empty() ? file : scene_.title;
  std::string body = fmt::format("<main>\n<header><h1>{}</h1>\n", escaped(title));
  body += fmt::format(
      "<p class=\"lead\">{}</p></header>\n",
      escaped(fmt::format("{}: frames {} to {}, run on the simulated card of cde.{}", file,
                          run["frames"][0].dump(), run["frames"][1].dump(), ended_early(run))));
  body += view_html() + (frame_results_.empty() ? "" : distances_html()) + charts_html() +
          tables_html(run);
  body += fmt::format(
      "<footer><details><summary>Software in this page</summary><pre>{}</pre>"
      "</details></footer>\n</main>\n",
      escaped(kThreeLicence.text));
  return page(title, body, data(run), {&kThreeScript, &kReportScript, &kChartScript});
}

}  // namespace cde::cli
