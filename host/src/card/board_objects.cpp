// SPDX-License-Identifier: Apache-2.0
// Objects: ranges of shapes that the card's object tables move by rigid transforms.
#include <fmt/format.h>

#include <array>
#include <bit>

#include "card/board_impl.hpp"
#include "cde/contract/records.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

constexpr std::uint32_t kEntryBytes = card::kObjectWords * 4;

[[noreturn]] void refuse(std::size_t number, const ObjectTable& table, const std::string& why) {
  throw Error(ErrorCode::kUsage, fmt::format("object {} of {}: {}", number, table.slots, why));
}

void require_table(const ObjectTable& table) {
  if (table.entries == 0) {
    throw Error(ErrorCode::kUsage,
                fmt::format("this card has no transformer for {}; open the board with "
                            "BoardConfig::transform",
                            table.slots));
  }
}

void check_transform(const ObjectTable& table, std::size_t number, const Transform& transform,
                     FpFormat format) {
  if (const auto why = defect(transform, format)) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("object {} of {}: {}", number, table.slots, *why));
  }
}

}  // namespace

void Board::Impl::check_object(const ObjectTable& table, std::size_t number,
                               const Object& object) const {
  const std::uint64_t end = std::uint64_t{object.first} + object.count;
  if (object.count == 0) refuse(number, table, "its range is empty");
  const bool of_primaries = &table == &primary_objects;
  const std::uint64_t there = of_primaries ? loaded + second_loaded : secondaries;
  if (there != 0 && end > there) {
    refuse(number, table,
           fmt::format("slots {} to {} exceed the {} {}", object.first, end - 1, there,
                       of_primaries ? "loaded" : "uploaded"));
  }
  if (of_primaries && object.first < loaded && end > loaded && second_loaded != 0)
    refuse(number, table, "its range has primaries of both pairs");
  const bool boxes = of_primaries ? (loaded != 0 && primary_shape == Shape::kAabb) ||
                                        (second_loaded != 0 && second_shape == Shape::kAabb)
                                  : secondaries != 0 && secondary_shape == Shape::kAabb;
  if (boxes && !is_translation(object.transform))
    refuse(number, table, "an AABB cannot be rotated on the card; upload OBBs");
}

void Board::Impl::write_transform(ObjectTable& table, std::size_t number) {
  table.posed[number] = false;
  std::array<std::uint32_t, Transform::kWords> slot{};
  const auto numbers = to_words(table.objects[number].transform);
  for (std::size_t k = 0; k < slot.size(); ++k)
    slot[k] = static_cast<std::uint32_t>(coding.encode(numbers[k]));
  write(card::kSpaceReg,
        table.offset + static_cast<std::uint32_t>(number) * kEntryBytes + card::kObjectRotation * 4,
        slot.data(), slot.size() / 2);
  table.posed[number] = true;
}

void Board::Impl::write_object(ObjectTable& table, std::size_t number) {
  const Object& object = table.objects[number];
  std::uint32_t first = object.first;
  // Primaries of the second pair begin on their own row.
  if (&table == &primary_objects && second_loaded != 0 && first >= loaded)
    first += split() - loaded;
  if (table.placed[number] == first) return;
  table.placed[number] = ~0u;
  const std::array<std::uint32_t, 2> range = {first, object.count};
  write(card::kSpaceReg, table.offset + static_cast<std::uint32_t>(number) * kEntryBytes,
        range.data(), 1);
  table.placed[number] = first;
}

void Board::Impl::prepare_objects() {
  for (ObjectTable* table : {&objects, &primary_objects}) {
    for (std::size_t i = 0; i < table->objects.size(); ++i) {
      check_object(*table, i, table->objects[i]);
      write_object(*table, i);
      if (!table->posed[i]) write_transform(*table, i);
    }
  }
}

std::uint64_t Board::Impl::tested_secondaries(const Query& query) const {
  if (objects.objects.empty())
    return query.secondary_count != 0 ? query.secondary_count : secondaries - query.first_secondary;
  std::uint64_t sum = 0;
  for (const Object& object : objects.objects) sum += object.count;
  return sum;
}

void Board::Impl::set_objects(ObjectTable& table, std::span<const Object> all) {
  link->alive();
  require_table(table);
  if (all.size() > table.entries) {
    throw Error(ErrorCode::kUsage, fmt::format("{} objects of {} do not fit the card's table of {}",
                                               all.size(), table.slots, table.entries));
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    check_transform(table, i, all[i].transform, format);
    check_object(table, i, all[i]);
  }
  table.assign({all.begin(), all.end()});
  if (&table == &objects && !bvh.firsts.empty()) outdate_bvh(0, secondaries);
  for (std::size_t i = 0; i < all.size(); ++i) {
    write_object(table, i);
    write_transform(table, i);
  }
  check_bus("the upload of objects");
}

void Board::Impl::move_object(ObjectTable& table, std::size_t number, const Transform& transform) {
  link->alive();
  require_table(table);
  if (number >= table.objects.size()) {
    throw Error(ErrorCode::kUsage, fmt::format("there is no object {} of {}; there are {}", number,
                                               table.slots, table.objects.size()));
  }
  check_transform(table, number, transform, format);
  Object moved = table.objects[number];
  moved.transform = transform;
  check_object(table, number, moved);
  table.objects[number] = moved;
  if (&table == &objects && !bvh.firsts.empty()) outdate_bvh(number);
  write_transform(table, number);
  check_bus("the upload of a transform");
}

void Board::set_objects(std::span<const Object> objects) {
  idle_card().set_objects(idle_card().objects, objects);
}
void Board::move_object(std::size_t object, const Transform& transform) {
  idle_card().move_object(idle_card().objects, object, transform);
}
void Board::set_primary_objects(std::span<const Object> objects) {
  idle_card().set_objects(idle_card().primary_objects, objects);
}
void Board::move_primary_object(std::size_t object, const Transform& transform) {
  idle_card().move_object(idle_card().primary_objects, object, transform);
}

}  // namespace cde
