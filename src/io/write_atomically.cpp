#include "rbvi/io/write_atomically.hpp"

#include "rbvi/io/system_error.hpp"
#include "rbvi/io/temporary_files.hpp"

#include <cerrno>
#include <condition_variable>
#include <fcntl.h>
#include <mutex>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace rbvi {

namespace {

using Path = std::filesystem::path;

/// The files that are being written, from the first byte to the name.
struct Writing {
  std::mutex mutex;
  std::condition_variable changed;
  int files = 0;
  bool stopped = false;

  void begin() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return !stopped; }); // the process ends with it
    ++files;
  }
  void end() {
    const std::lock_guard lock(mutex);
    --files;
    changed.notify_all();
  }
} writing;

/// An open file descriptor.
class Output {
public:
  explicit Output(int descriptor) : descriptor_(descriptor) {}
  Output(const Output &) = delete;
  Output &operator=(const Output &) = delete;
  ~Output() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  int get() const { return descriptor_; }
  int close() { return ::close(std::exchange(descriptor_, -1)); }

private:
  int descriptor_;
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
  Output out(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (out.get() < 0 || !write_all(out.get(), bytes) || out.close() != 0)
    throw cannot_write(path.string());
}

/// Makes a new, empty file beside `path`; processes that write at the same time get different ones.
Path make_temporary(const Path &path) {
  Path name;
  int descriptor = -1;
  for (int attempt = 0; descriptor < 0; ++attempt) {
    name = temporary_name(path, attempt);
    descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno != EEXIST) throw cannot_write(path.string());
  }
  ::close(descriptor);
  return name;
}

/// Where a link leads to. Throws failure for a directory.
Path target_of(const Path &path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status))
    throw failure("cannot write " + path.string() + ": it is a directory");
  if (!std::filesystem::exists(status)) return path;
  const Path target = std::filesystem::canonical(path, error);
  if (error) throw failure("cannot write " + path.string() + ": " + error.message());
  return target;
}

/// Makes a file durable where its file system can: those of some networks cannot.
bool synced(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP;
}

/// Gives a new file the mode of the one that it replaces, where its file system has modes.
void keep_mode(int descriptor, const Path &before) {
  struct stat facts {};
  if (::stat(before.c_str(), &facts) == 0 && ::fchmod(descriptor, facts.st_mode & 07777U) != 0)
    errno = 0;
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
  std::unique_lock lock(writing.mutex);
  writing.stopped = true;
  return writing.changed.wait_for(lock, patience, [] { return writing.files == 0; });
}

void make_directory(const Path &path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw failure("cannot make the directory " + path.string() + ": " + error.message());
}

AtomicFile::AtomicFile(const Path &path) : target_(target_of(path)) {
  writing.begin();
  try {
    temporary_ = make_temporary(target_);
  } catch (...) {
    writing.end();
    throw;
  }
}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty()) {
    ::unlink(temporary_.c_str());
    writing.end();
  }
}

void AtomicFile::commit() {
  Output out(::open(temporary_.c_str(), O_WRONLY | O_CLOEXEC));
  if (out.get() >= 0) keep_mode(out.get(), target_);
  if (out.get() < 0 || !synced(out.get()) || out.close() != 0 ||
      ::rename(temporary_.c_str(), target_.c_str()) != 0)
    throw cannot_write(target_.string());
  sync_directory(target_);
  temporary_.clear();
  writing.end();
}

void AtomicFile::leave() {
  if (!std::exchange(temporary_, {}).empty()) writing.end();
}

void AtomicFile::append(const std::string &bytes) const {
  Output out(::open(temporary_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC));
  if (out.get() < 0 || !write_all(out.get(), bytes) || out.close() != 0)
    throw cannot_write(target_.string());
}

void write_atomically(const Path &path, const std::string &bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_directory(status) &&
      !std::filesystem::is_regular_file(status))
    return write_directly(path, bytes);
  AtomicFile file(path);
  file.append(bytes);
  file.commit();
}

} // namespace rbvi
