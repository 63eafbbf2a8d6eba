#include "player_secondaries.hpp"

#include <algorithm>
#include <bit>

namespace cde::player {

ObjectState::ObjectState(const Scene& scene, const SceneObject& object)
    : scene_(&scene),
      object_(&object),
      still_(is_still(scene, object)),
      deforming_(deforming(object)),
      world_(object.shapes) {}

void ObjectState::show(std::uint32_t frame) {
  if (frame_ == frame) return;
  changed_.clear();
  const bool first = !frame_.has_value();
  frame_ = frame;
  if (!first && still_ && deforming_.empty()) return;
  const Shapes local = local_shapes(*scene_, *object_, frame);
  world_ = has_member_poses(*object_) ? posed(local, member_poses(*scene_, *object_, frame))
                                      : posed(local, pose(*scene_, *object_, frame));
  if (first || !still_)
    changed_ = {{0, size(world_)}};
  else
    changed_ = deforming_;
  ++version_;
}

Shapes joined(const std::vector<std::size_t>& objects, const std::vector<ObjectState>& states) {
  Shapes all = states[objects.front()].world();
  std::visit(
      [&](auto& list) {
        for (std::size_t i = 1; i < objects.size(); ++i) {
          const auto& more = std::get<std::decay_t<decltype(list)>>(states[objects[i]].world());
          list.insert(list.end(), more.begin(), more.end());
        }
      },
      all);
  return all;
}

std::uint64_t Secondaries::show(const std::vector<std::size_t>& objects,
                                const std::vector<ObjectState>& states) {
  std::vector<std::uint64_t> versions;
  versions.reserve(objects.size());
  for (const std::size_t i : objects) versions.push_back(states[i].version());
  if (objects != objects_) {
    objects_ = objects;
    versions_ = versions;
    shapes_ = joined(objects, states);
    std::visit([&](const auto& list) { board_->upload_shapes(std::span(list), false); }, shapes_);
    return size(shapes_) * words(shape_of(shapes_));
  }
  std::uint64_t uploaded = 0;
  std::size_t base = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectState& state = states[objects[i]];
    // What changed since the version before is known; further back everything may have.
    const bool next = versions[i] == versions_[i] + 1;
    std::vector<Range> changed;
    if (next) changed = state.changed();
    if (versions[i] > versions_[i] + 1) changed = {{0, size(state.world())}};
    std::visit(
        [&](auto& all) {
          const auto& own = std::get<std::decay_t<decltype(all)>>(state.world());
          for (const Range& range : changed) {
            const auto from = own.begin() + static_cast<std::ptrdiff_t>(range.first);
            std::copy_n(from, range.count,
                        all.begin() + static_cast<std::ptrdiff_t>(base + range.first));
          }
        },
        shapes_);
    for (const Range& range : changed) uploaded += upload(base + range.first, range.count);
    base += size(state.world());
  }
  versions_ = versions;
  return uploaded;
}

/// A beat is two words: a range is rounded out to whole beats with its neighbours' words.
std::uint64_t Secondaries::upload(std::size_t first, std::size_t count) {
  const std::size_t slot = words(shape_of(shapes_));
  const std::size_t begin = first * slot / 2 * 2, all = size(shapes_) * slot;
  const std::size_t end = std::min((first + count) * slot + 1, all + 1) / 2 * 2;
  const std::size_t from = begin / slot, to = std::min((end - 1) / slot + 1, size(shapes_));
  std::vector<std::uint32_t> image(std::max(to * slot, end) - from * slot, 0);
  std::visit(
      [&](const auto& list) {
        using P = typename std::decay_t<decltype(list)>::value_type;
        for (std::size_t i = from; i < to; ++i) {
          const auto shape = to_words(list[i]);
          for (std::size_t k = 0; k < P::kWords; ++k)
            image[(i - from) * slot + k] = std::bit_cast<std::uint32_t>(shape[k]);
        }
      },
      shapes_);
  constexpr std::size_t kChunk = 4096;  // beats
  std::vector<std::uint64_t> beats;
  for (std::size_t word = begin; word < end; word += 2 * kChunk) {
    beats.clear();
    for (std::size_t w = word; w < std::min(end, word + 2 * kChunk); w += 2) {
      const std::uint64_t low = image[w - from * slot], high = image[w + 1 - from * slot];
      beats.push_back(high << 32 | low);
    }
    board_->bus_write(card::kSpaceDdr, static_cast<std::uint32_t>(4 * word), beats);
  }
  return end - begin;
}

}  // namespace cde::player
