// SPDX-License-Identifier: Apache-2.0
#include "cde/reference/record_check.hpp"

#include <fmt/format.h>

#include <bit>

#include "cde/support/error.hpp"

namespace cde::reference {
namespace {

std::string vector_text(const Eigen::Vector3f& v) {
  return fmt::format("{:a},{:a},{:a} ({:08x} {:08x} {:08x})", v.x(), v.y(), v.z(),
                     std::bit_cast<std::uint32_t>(v.x()), std::bit_cast<std::uint32_t>(v.y()),
                     std::bit_cast<std::uint32_t>(v.z()));
}

std::string record_text(const std::optional<Record>& r, const std::string& noun) {
  if (!r) return "no record";
  std::string text = fmt::format("{} {} F {}{} T {:a} ({:08x}) CP {}", noun, r->primary,
                                 r->f ? 1 : 0, r->bad ? " bad" : "", r->t,
                                 std::bit_cast<std::uint32_t>(r->t), vector_text(r->cp));
  if (noun != "ray") text += " n " + vector_text(r->n);
  return text + fmt::format(" index {}", static_cast<std::int32_t>(r->index));
}

std::string words_text(const std::vector<float>& words) {
  std::string text;
  for (const float w : words) text += fmt::format("{}{:a}", text.empty() ? "" : ",", w);
  return text;
}

}  // namespace

void RecordCheck::compare(std::span<const Record> records) {
  for (const Record& record : records) {
    if (pending_.empty()) pending_ = source_();
    if (pending_.empty()) {
      differ(&record, nullptr);
      continue;
    }
    const Record& expected = pending_.front();
    if (same_bits(record, expected))
      ++compared_, ++matching_;
    else
      differ(&record, &expected);
    pending_ = pending_.subspan(1);
  }
}

void RecordCheck::compare_end() {
  if (pending_.empty()) pending_ = source_();
  for (; !pending_.empty(); pending_ = source_())
    for (const Record& expected : pending_) differ(nullptr, &expected);
}

void RecordCheck::differ(const Record* card, const Record* expected) {
  ++compared_;
  if (first_) return;
  first_.emplace();
  if (card != nullptr) first_->card = *card;
  if (expected != nullptr) first_->reference = *expected;
  first_->primary = report_.primary(first_->number());
  for (const auto& record : {first_->reference, first_->card}) {
    if (!record) continue;
    const bool known =
        !first_->secondaries.empty() && first_->secondaries.front().first == record->index;
    std::vector<float> words = report_.secondary(record->index);
    if (!known && !words.empty()) first_->secondaries.emplace_back(record->index, std::move(words));
  }
  difference_ = text();
}

std::string RecordCheck::text() const {
  const Difference& d = *first_;
  const std::uint32_t number = d.number();
  std::string text = fmt::format(
      "{} {}: the card's record differs from the reference\n  card      {}\n"
      "  reference {}\n  differ in {}\n",
      report_.noun, number, record_text(d.card, report_.noun),
      record_text(d.reference, report_.noun),
      d.card && d.reference ? differing_fields(*d.card, *d.reference) : "all");
  if (report_.place) text += fmt::format("  where     {}\n", report_.place(number));
  if (!d.primary.empty())
    text += fmt::format("  {} {}: {}\n", report_.noun, number, words_text(d.primary));
  for (const auto& [index, words] : d.secondaries)
    text += fmt::format("  {} {}: {}\n", report_.noun == "ray" ? "triangle" : "secondary", index,
                        words_text(words));
  if (report_.repeat) text += "repeat with: " + report_.repeat(d);
  return text;
}

void RecordCheck::check(std::span<const Record> records) {
  for (std::size_t i = 0; i < records.size() && difference_.empty(); ++i)
    compare(records.subspan(i, 1));
  if (!difference_.empty()) throw Error(ErrorCode::kMismatch, difference_);
}

void RecordCheck::finish() {
  compare_end();
  if (!difference_.empty()) throw Error(ErrorCode::kMismatch, difference_);
}

}  // namespace cde::reference
