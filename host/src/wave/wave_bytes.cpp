// SPDX-License-Identifier: Apache-2.0
#include "wave/wave_bytes.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/process.hpp"

namespace cde::wave {
namespace {

/// Most bytes to read from a pipe: an endless program must not fill the disk.
constexpr std::uint64_t kMostSpooled = std::uint64_t{64} << 30;
constexpr std::size_t kSpoolPart = 1u << 18;

/// A nameless file that ends with this process.
int nameless_file() {
  std::error_code none;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(none);
  const int fd = none ? -1 : ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_EXCL | O_CLOEXEC, 0600);
  return fd >= 0 ? fd : ::memfd_create("waves", MFD_CLOEXEC);
}

std::string error_text() {
  return std::strerror(errno);  // NOLINT(concurrency-mt-unsafe)
}

/// Releases zlib's stream in any case.
struct Inflater {
  z_stream stream{};
  bool begun = ::inflateInit2(&stream, 15 + 16) == Z_OK;
  Inflater() = default;
  ~Inflater() {
    if (begun) ::inflateEnd(&stream);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
};

}  // namespace

WaveBytes::WaveBytes(const std::filesystem::path& file)
    : name_(file == "-" ? "stdin" : printable_name(file.string())) {
  if (file == "-") {
    spool(STDIN_FILENO);
    return;
  }
  descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) {
    const std::string why = error_text();
    if (descriptor_ >= 0) ::close(descriptor_);
    fail("cannot be read: " + why);
  }
  if (S_ISFIFO(status.st_mode)) {
    const int pipe = std::exchange(descriptor_, -1);
    // Without a writer yet, a read would find the end of the pipe.
    pollfd writer{pipe, POLLIN, 0};
    while (::poll(&writer, 1, -1) < 0 && errno == EINTR) {
    }
    ::fcntl(pipe, F_SETFL, 0);
    try {
      spool(pipe);
    } catch (...) {
      ::close(pipe);
      throw;
    }
    ::close(pipe);
    return;
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(descriptor_);
    fail("is not a regular file; expected a regular file or a pipe");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

WaveBytes::~WaveBytes() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

WaveBytes::WaveBytes(WaveBytes&& other) noexcept
    : name_(std::move(other.name_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

WaveBytes& WaveBytes::operator=(WaveBytes&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  return *this;
}

void WaveBytes::fail(const std::string& what) const {
  throw Error(ErrorCode::kFile, fmt::format("{}: {}", name_, what));
}

std::size_t WaveBytes::read(std::uint64_t offset, char* to, std::size_t count) const {
  std::size_t done = 0;
  while (done < count) {
    const ssize_t n =
        ::pread(descriptor_, to + done, count - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot be read: " + error_text());
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  return done;
}

void WaveBytes::append(const char* bytes, std::size_t count) {
  if (!process::write_all(descriptor_, {bytes, count}))
    fail("cannot be kept in a temporary file: " + error_text());
  size_ += count;
}

void WaveBytes::spool(int from) {
  descriptor_ = nameless_file();
  if (descriptor_ < 0) fail("cannot create a temporary file: " + error_text());
  std::vector<char> part(kSpoolPart);
  try {
    while (true) {
      const ssize_t n = ::read(from, part.data(), part.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail("cannot be read: " + error_text());
      if (n == 0) break;
      if (size_ + static_cast<std::uint64_t>(n) > kMostSpooled)
        fail(fmt::format("exceeds {} GiB, the limit for a pipe", kMostSpooled >> 30));
      append(part.data(), static_cast<std::size_t>(n));
    }
  } catch (...) {
    ::close(std::exchange(descriptor_, -1));
    throw;
  }
}

WaveBytes WaveBytes::inflated(std::uint64_t offset, std::uint64_t size) const {
  WaveBytes all;
  all.name_ = name_;
  all.descriptor_ = nameless_file();
  if (all.descriptor_ < 0) fail("cannot create a temporary file: " + error_text());
  Inflater inflater;
  if (!inflater.begun) fail("cannot be unpacked: zlib has no memory");
  z_stream& z = inflater.stream;
  std::vector<char> in(kSpoolPart), out(kSpoolPart);
  for (int state = Z_OK; state != Z_STREAM_END;) {
    if (z.avail_in == 0) {
      const std::size_t n = read(offset, in.data(), in.size());
      offset += n;
      z.next_in = reinterpret_cast<Bytef*>(in.data());
      z.avail_in = static_cast<uInt>(n);
      if (n == 0) fail("is cut off: its gzip stream has no end");
    }
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    state = ::inflate(&z, Z_NO_FLUSH);
    if (state != Z_OK && state != Z_STREAM_END && state != Z_BUF_ERROR)
      fail(fmt::format("is corrupt: its gzip stream is damaged near byte {}", offset - z.avail_in));
    const std::size_t n = out.size() - z.avail_out;
    if (n > size - all.size_)
      fail(fmt::format("is corrupt: it unpacks to more than the {} bytes that it announces", size));
    all.append(out.data(), n);
  }
  if (all.size_ != size)
    fail(fmt::format("is corrupt: it unpacks to {} bytes and announces {}", all.size_, size));
  return all;
}

std::string utf8_text(std::string text) {
  bool plain = true;
  for (const char c : text) plain = plain && static_cast<unsigned char>(c) < 0x80;
  if (plain || valid_utf8(text) == text) return text;
  std::string wide;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      wide.push_back(c);
    } else {
      wide.push_back(static_cast<char>(0xc0 | byte >> 6));
      wide.push_back(static_cast<char>(0x80 | (byte & 0x3f)));
    }
  }
  return wide;
}

}  // namespace cde::wave
