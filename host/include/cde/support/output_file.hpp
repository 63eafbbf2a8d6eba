// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/support/error.hpp"

namespace cde {

/// What a folder that this process holds open has under a name.
struct NameInFolder {
  int folder = -1;  ///< its descriptor
  std::string name;
};

/// Every file that cde writes is one of these: the library's pictures and meshes as well as the
/// command's records, pages and waves.
///
/// A regular file, or one that is not there yet, is written under another name in the same folder
/// and renamed by commit(), so that a reader sees the old file or the whole new one; the mode of
/// the old one stays. Of a symbolic link the target is written, and the link stays. What is there
/// and is no regular file (a device, a FIFO, a descriptor of this process such as /dev/stdout) is
/// opened and written to as it comes. "-" is stdout.
///
/// The other name is NAME.cde-PID-RANDOM, and locked. Left uncommitted the file is removed; what a
/// process that was killed left behind is swept away by the next one that writes the same NAME.
///
/// The folder may belong to another user, who can put another file in the place of either name.
/// Mode and owner are therefore set by descriptor, commit() fails if the other name no longer leads
/// to what was written, and a symbolic link of another user must lead to what belongs to that user.
class OutputFile {
 public:
  enum class Use {
    kBytes,   ///< write() fills it
    kByName,  ///< somebody else opens by_name() and fills it
  };

  /// Error kFile if it cannot be written: no such folder, a folder itself, no permission.
  explicit OutputFile(const std::filesystem::path& path, Use use = Use::kBytes);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Error kFile, and StdoutError of stdout.
  void write(std::string_view bytes);
  /// Whether replace_start() is possible: not of a device, a pipe or stdout.
  [[nodiscard]] bool can_replace_start() const { return !temporary_.name.empty(); }
  /// Writes over the first bytes, which must be written. What follows them stays.
  void replace_start(std::string_view bytes);
  void flush();  ///< for those who wait at the other end of a pipe
  void commit();

  /// A name of the regular file that is written, for writers that open files themselves. It leads
  /// to this process's descriptor, whatever becomes of the folder. Invalid from commit() on.
  [[nodiscard]] std::string by_name() const;
  /// Sets the permission bits of the file that is written. The umask does not matter.
  void set_mode(unsigned mode);

  /// From now on stdout gets what is written to "-" when it is committed, not as it comes.
  static void hold_stdout();

  /// Removes whatever is uncommitted in this process. For handlers of signals that end it: calls
  /// nothing but unlinkat.
  static void remove_unfinished() noexcept;

 private:
  void make_temporary();
  void make_spool();
  void spill();
  void put_in_place(int fd);
  [[noreturn]] void fail(const char* doing) const;

  std::filesystem::path path_, target_;  // as it was named, and with links followed
  NameInFolder temporary_;  // commit() renames it to target_; no name: the target is written to
  int folder_ = -1;         // of both
  bool stdout_ = false;
  std::FILE* file_ = nullptr;  // the target, or what becomes of it
  std::FILE* held_ = nullptr;  // what write() fills instead
  int spool_ = -1;             // of held_, or what others fill by name: commit() copies it
};

/// A folder for outputs, made with those above it if they are not there. Those that it made and
/// that are empty are gone again when it ends without keep(), or by
/// OutputFile::remove_unfinished(). They are removed from the folders they were made in, whatever
/// those are called by then.
class OutputFolder {
 public:
  /// Error kFile if it cannot be made, or if it is a link of another user to what is not that
  /// user's.
  explicit OutputFolder(const std::filesystem::path& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  [[nodiscard]] bool made() const { return !made_.empty(); }
  void keep();
  /// Error kFile if its name leads elsewhere by now.
  void check() const;
  /// The folder itself, open while this object is, whatever lies under its name by now.
  [[nodiscard]] int descriptor() const { return folder_; }

 private:
  void take_back();
  std::filesystem::path path_;
  std::vector<NameInFolder> made_;  ///< the innermost last
  int folder_ = -1;
};

/// Writes all of a file by OutputFile.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// stdout cannot be written.
class StdoutError : public Error {
 public:
  explicit StdoutError(int number);
  [[nodiscard]] int number() const noexcept { return number_; }  ///< as in errno

 private:
  int number_;
};

/// A file that a command reads or writes, and the option that names it. An empty path is none; "-"
/// is stdin or stdout.
struct FileUse {
  std::string option;
  std::filesystem::path path;
};

/// Error kUsage, naming both options, if two outputs are one file, or an output is an input: the
/// same inode, however it is named. /dev/null may be any number of outputs, a terminal input and
/// output. Error kFile if an output cannot be one: its folder is missing, or it is a folder.
void check_outputs(std::span<const FileUse> outputs, std::span<const FileUse> inputs);

/// Whether a name in a folder is one that OutputFile gives to unfinished files.
[[nodiscard]] bool is_unfinished_name(std::string_view name);

/// Removes unfinished files from a folder, of every NAME or of the one given, which no process
/// works on any more.
void sweep_unfinished(const std::filesystem::path& folder, std::string_view name = {});

}  // namespace cde
