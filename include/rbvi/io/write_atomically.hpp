// Files that are the old one or the new one, never half.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

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

/// "<path>.tmp.<hash of the host's name>.<process>.<attempt>"
std::filesystem::path temporary_name(const std::filesystem::path &path, int attempt);

/// Removes the temporary files in `directory`, those of file `of` alone where it is named, whose
/// process no longer runs on this host. Those of other hosts stay: nobody can tell. Does nothing
/// where there is no such directory.
void remove_stale_temporaries(const std::filesystem::path &directory, const std::string &of = "");

/// For a process that another of its threads is about to end: lets the file that is being written
/// come to its name, for at most `patience`, and no other be begun. False if time ran out: then it
/// may be called again.
bool stop_writing(std::chrono::milliseconds patience);

/// A file and what it is to the user: {"the file of queries", "mu.csv"}.
struct NamedFile {
  std::string what;
  std::filesystem::path path;
};

/// Throws bad_input if `output` ("--out", "answers.csv") is one of `inputs`, however the two are
/// spelt: through links, "./", "..". Empty paths are none.
void check_overwriting(const NamedFile &output, const std::vector<NamedFile> &inputs);

} // namespace rbvi
