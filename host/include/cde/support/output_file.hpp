// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/stat.h>

#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/support/error.hpp"

namespace cde {

/// A name within a folder that this process holds open.
struct NameInFolder {
  int folder = -1;  ///< file descriptor of the folder
  std::string name;
};

/// Every file that the library or the command writes is an OutputFile: pictures, meshes, records,
/// pages and waves.
///
/// A regular or new file is written under a temporary name in the same folder. Then commit()
/// renames it. A reader sees the old file or the complete new one. Until commit() only this user
/// can open the new file. Then it gets the owner, mode and access control list of the old file. A
/// symbolic link stays, and its target is written. Anything else that exists (a device, a FIFO, a
/// descriptor such as /dev/stdout) is opened and written directly. "-" is stdout.
///
/// The temporary name is NAME.cde-PID-RANDOM, and the file is locked. Without commit() the file is
/// removed. The next process that writes the same NAME removes what a killed process left behind.
///
/// The folder may belong to another user, who can replace either name. Mode and owner are therefore
/// set by descriptor. commit() fails if the temporary name no longer leads to the written file. It
/// fails if the target is now another user's file that was not there at check_outputs(). Without
/// that call, the file must have been there at the construction. A symbolic link of another user
/// must lead to a file of that user.
class OutputFile {
 public:
  enum class Use {
    kBytes,   ///< write() fills it
    kByName,  ///< another writer opens by_name() and fills it
  };

  /// Error kFile if the file cannot be written: no such folder, the path is a folder, no
  /// permission.
  explicit OutputFile(const std::filesystem::path& path, Use use = Use::kBytes);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Error kFile; StdoutError for stdout.
  void write(std::string_view bytes);
  /// Whether replace_start() is possible. It is not for a device, a pipe or stdout.
  [[nodiscard]] bool can_replace_start() const { return !temporary_.name.empty(); }
  /// Overwrites the first bytes, which must already be written. The bytes after them stay.
  void replace_start(std::string_view bytes);
  void flush();  ///< for a reader at the other end of a pipe
  void commit();

  /// A name for the regular file being written, for writers that open files themselves. It leads to
  /// this process's descriptor, even if the folder is renamed or replaced. Invalid after commit().
  [[nodiscard]] std::string by_name() const;
  /// Sets the permission bits of the file being written, whatever the umask is.
  void set_mode(unsigned mode);

  /// From now on, bytes for "-" reach stdout at commit(), not as they are written.
  static void buffer_stdout();

  /// Removes all uncommitted files and all Scratch folders of this process. For handlers of signals
  /// that end it: calls only functions that a handler may call.
  static void remove_unfinished() noexcept;

 private:
  void make_temporary();
  bool lock_temporary(int fd) const;
  void make_spool();
  void spill();
  void move_into_place(int fd);
  void set_owner_and_mode(int fd);
  [[noreturn]] void fail(const char* doing) const;

  std::filesystem::path path_, target_;  // as it was named, and with links followed
  NameInFolder temporary_;  // commit() renames it to target_; empty: the target is written directly
  int folder_ = -1;         // folder of both names
  std::optional<struct stat> found_;       // the file at target_ at the start, if any
  std::optional<unsigned> replaced_mode_;  // permissions of the file that is replaced
  unsigned new_mode_ = 0600;               // permissions of a file that replaces none
  bool stdout_ = false;
  std::FILE* file_ = nullptr;  // the target, or the temporary file
  std::FILE* held_ = nullptr;  // buffer that write() fills instead of file_
  // Descriptor of held_, or the file that another writer fills by name; commit() copies it.
  int spool_ = -1;
};

/// A folder for outputs, created with its parents if missing. A symbolic link to a missing folder
/// stays, and that folder is created if its own folder exists. Folders that it created are removed
/// again if they are empty and keep() was not called. The destructor or
/// OutputFile::remove_unfinished() removes them. They are removed by descriptor, even if a parent
/// was renamed. A created folder has the mode that the umask allows, and no ACL of its parent.
class OutputFolder {
 public:
  /// Error kFile if the folder cannot be created, or another user replaces it at once. Error kFile
  /// for a symbolic link of another user to a folder that is not that user's.
  explicit OutputFolder(const std::filesystem::path& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  /// Whether it was created, and not another process has put files into it.
  [[nodiscard]] bool made() const { return made_; }
  void keep();
  /// Error kFile if the path leads elsewhere by now.
  void check() const;
  /// Descriptor of the folder, open while this object lives, whatever the path leads to by now.
  [[nodiscard]] int descriptor() const { return folder_; }

 private:
  int make(int around, const std::string& name);
  void remove_created();
  std::filesystem::path path_;
  std::vector<NameInFolder> created_;  ///< with its parents, innermost last
  bool made_ = false;
  int folder_ = -1;
};

/// Writes a whole file through OutputFile.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// An error for which stdout cannot be written.
class StdoutError : public Error {
 public:
  explicit StdoutError(int number);
  [[nodiscard]] int number() const noexcept { return number_; }  ///< errno

 private:
  int number_;
};

/// A file that a command reads or writes, and the option that names it. An empty path means no
/// file; "-" is stdin or stdout.
struct FileUse {
  std::string option;
  std::filesystem::path path;
};

/// Error kUsage, naming both options, if two outputs are the same file, or an output is an input.
/// Files are the same if they have the same inode. /dev/null may be several outputs; a terminal may
/// be input and output. Error kFile if an output cannot be written: its folder is missing, or it is
/// a folder. The folders stay open in this process: an OutputFile of the same path is written to
/// the folder that was checked, even if another one has taken its name. It is not written if
/// another user has put a file there since.
void check_outputs(std::span<const FileUse> outputs, std::span<const FileUse> inputs);

/// Why a path cannot name a new folder, as "it ends with .."; nothing if it can.
[[nodiscard]] std::optional<std::string> why_no_new_folder(const std::filesystem::path& path);

/// Whether a name is one that OutputFile gives to unfinished files.
[[nodiscard]] bool is_unfinished_name(std::string_view name);

/// Removes unfinished files that no process is working on from a folder: the files of one NAME, or
/// all.
void sweep_unfinished(const std::filesystem::path& folder, std::string_view name = {});

}  // namespace cde
