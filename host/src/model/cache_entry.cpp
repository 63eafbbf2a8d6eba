// SPDX-License-Identifier: Apache-2.0
#include "cde/model/cache_entry.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "model/folders.hpp"
#include "support/file_io.hpp"
#include "support/sha256.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;

void refuse(const fs::path& file, std::string_view why) {
  log(fmt::format("cde: {} is not used: it {}\n", printable_name(file.string()), why));
}

std::optional<std::string> text_of(const fs::path& file) {
  try {
    return file_io::read_regular(file);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// The checksum of an entry. It covers the name, so that no entry can stand for another one.
std::string checksum(const std::string& name, std::string_view text) {
  return sha256(fmt::format("{}\n{}", name, text));
}

/// Writes a file independent of the umask: cde does not read files that others may write.
void write_private(const fs::path& file, std::string_view text) {
  OutputFile out(file);
  out.set_mode(S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH);
  out.write(text);
  out.commit();
}

}  // namespace

std::string cache_key(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += fmt::format("{} {}\n", part.size(), part);
  return sha256(all).substr(0, 24);
}

std::optional<std::string> read_cache_entry(const std::string& name) {
  const auto folder = folders::open(folders::cache());
  if (!folder) return std::nullopt;
  const fs::path file = folder->inside / name;
  std::error_code none;
  if (folder->distrust) {
    refuse(folder->named, *folder->distrust);
    return std::nullopt;
  }
  if (!fs::exists(file, none)) return std::nullopt;
  for (const fs::path& part : {file, folders::checksum_file(file)}) {
    const fs::path named = folder->named / part.filename();
    if (const auto why = folders::distrust(part, named)) {
      refuse(named, *why);
      return std::nullopt;
    }
  }
  const auto text = text_of(file), sum = text_of(folders::checksum_file(file));
  if (!text || !sum) {
    refuse(folder->named / name, text ? "has no checksum beside it" : "is no readable file");
    return std::nullopt;
  }
  const std::string stated = sum->substr(0, sum->find(' '));
  if (stated == sha256(*text)) return std::nullopt;  // of a version that did not cover the name
  if (stated != checksum(name, *text)) {
    refuse(folder->named / name, "is damaged: its checksum differs");
    return std::nullopt;
  }
  return text;
}

void write_cache_entry(const std::string& name, std::string_view text) {
  try {
    const fs::path file = folders::make_cache().inside / name;
    std::error_code none;
    fs::remove(file, none);  // a refused file keeps neither its owner nor its mode
    fs::remove(folders::checksum_file(file), none);
    write_private(folders::checksum_file(file),
                  fmt::format("{}  {}\n", checksum(name, text), name));
    write_private(file, text);
  } catch (const Error& e) {
    log(fmt::format("cde: {} is not kept in the cache: {}\n", name, e.what()));
  }
}

}  // namespace cde
