// Files that are the old one or the new one, never half.
#pragma once

#include <filesystem>
#include <string>

namespace rbvi {

/// A file that is made under a temporary name beside its own, and gets its own once it is whole.
/// Until then the old one is there, afterwards the new one; if neither commit() nor the process
/// comes to an end well, no temporary file is left, or one that remove_stale_temporaries() takes
/// away. A link is followed. All functions throw failure.
class AtomicFile {
public:
  explicit AtomicFile(const std::filesystem::path &path);
  ~AtomicFile();
  AtomicFile(const AtomicFile &) = delete;
  AtomicFile &operator=(const AtomicFile &) = delete;
  /// The file to write, empty at first.
  const std::filesystem::path &temporary() const { return temporary_; }
  void append(const std::string &bytes) const;
  /// The mode of the file that is replaced, fsync, rename, fsync of the directory.
  void commit();
  /// Unless commit() was: leaves the temporary file to whoever wants what is in it.
  void leave();

private:
  std::filesystem::path target_, temporary_;
};

/// Writes `bytes` to `path` atomically: temporary file beside it, fsync, rename, fsync of the
/// directory; a link is followed, and a device or pipe is written directly. Throws failure; then
/// no temporary file is left.
void write_atomically(const std::filesystem::path &path, const std::string &bytes);

/// Makes a directory and those above it, where they are missing. Throws failure.
void make_directory(const std::filesystem::path &path);

} // namespace rbvi
