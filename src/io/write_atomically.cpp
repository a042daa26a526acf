#include "rbvi/io/write_atomically.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/temporary_files.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <mutex>
#include <unistd.h>
#include <utility>

namespace rbvi {

namespace {

using Path = std::filesystem::path;

/// Held from the first byte of a file to its name.
std::timed_mutex writing;

Error cannot_write(const Path &path) {
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
  return failure("cannot write " + path.string() + ": " + std::strerror(errno) +
                 (full ? "; make room and start the same command again" : ""));
}

/// An open file descriptor; the name is removed unless `keep` was called.
class Output {
public:
  Output(int descriptor, Path remove) : descriptor_(descriptor), remove_(std::move(remove)) {}
  Output(const Output &) = delete;
  Output &operator=(const Output &) = delete;
  ~Output() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!remove_.empty()) ::unlink(remove_.c_str());
  }
  int get() const { return descriptor_; }
  int close() { return ::close(std::exchange(descriptor_, -1)); }
  void keep() { remove_.clear(); }

private:
  int descriptor_;
  Path remove_;
};

bool write_all(int descriptor, const std::string &bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno != EINTR) return false;
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  return true;
}

void write_directly(const Path &path, const std::string &bytes) {
  Output out(::open(path.c_str(), O_WRONLY | O_CLOEXEC), {});
  if (out.get() < 0 || !write_all(out.get(), bytes) || out.close() != 0) throw cannot_write(path);
}

/// Opens a new file beside `path`; processes that write at the same time get different ones.
int open_temporary(const Path &path, Path &name) {
  int descriptor = -1;
  for (int attempt = 0; descriptor < 0; ++attempt) {
    name = temporary_name(path, attempt);
    descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno != EEXIST) throw cannot_write(path);
  }
  return descriptor;
}

/// Makes the new name durable. Some file systems cannot: the file itself is complete already.
void sync_directory(const Path &path) {
  const Path parent = path.has_parent_path() ? path.parent_path() : Path(".");
  const int directory = ::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory < 0) return;
  (void)::fsync(directory);
  ::close(directory);
}

} // namespace

bool stop_writing(std::chrono::milliseconds patience) {
  return writing.try_lock_for(patience); // the process ends with it
}

void make_directory(const Path &path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw failure("cannot make the directory " + path.string() + ": " + error.message());
}

void write_atomically(const Path &path, const std::string &bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status))
    throw failure("cannot write " + path.string() + ": it is a directory");
  const bool exists = std::filesystem::exists(status);
  if (exists && !std::filesystem::is_regular_file(status)) return write_directly(path, bytes);
  const Path target = exists ? std::filesystem::canonical(path, error) : path;
  if (error && exists) throw failure("cannot write " + path.string() + ": " + error.message());

  const std::lock_guard<std::timed_mutex> whole(writing);
  Path temporary;
  const int descriptor = open_temporary(target, temporary);
  Output out(descriptor, temporary);
  if (!write_all(out.get(), bytes) || ::fsync(out.get()) != 0 || out.close() != 0 ||
      ::rename(temporary.c_str(), target.c_str()) != 0)
    throw cannot_write(path);
  out.keep();
  sync_directory(target);
}

} // namespace rbvi
