#include "rbvi/io/write_atomically.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/parameters.hpp"
#include "rbvi/io/checksum.hpp"
#include "rbvi/io/system_error.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cinttypes>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <mutex>
#include <optional>
#include <sstream>
#include <utility>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

const std::string mark = ".tmp.";

/// Eight hexadecimal digits.
std::string host_mark() {
  char name[256] = "";
  if (::gethostname(name, sizeof name - 1) != 0) name[0] = '\0';
  const std::string host = name;
  char text[16];
  std::snprintf(text, sizeof text, "%08" PRIx32,
                static_cast<std::uint32_t>(fnv1a(host.data(), host.size())));
  return text;
}

bool is_number(const std::string &text) {
  return !text.empty() && text.size() < 10 &&
         text.find_first_not_of("0123456789") == std::string::npos;
}

/// The process that writes, or wrote, a temporary file of this host; nothing for other files.
std::optional<pid_t> writer_of(const std::string &name) {
  const std::size_t at = name.rfind(mark);
  if (at == std::string::npos || at == 0) return std::nullopt;
  const std::vector<std::string> parts = split(name.substr(at + mark.size()), '.');
  if (parts.size() != 3 || parts[0] != host_mark() || !is_number(parts[1]) || !is_number(parts[2]))
    return std::nullopt;
  return static_cast<pid_t>(std::stol(parts[1]));
}

/// Seconds since the epoch at which a process began; nothing where the system does not say.
std::optional<double> beginning_of(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  if (!std::getline(in, line) || line.rfind(')') == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(line.rfind(')') + 1)); // the name may hold anything
  std::string field;
  for (int number = 3; number <= 22; ++number) // proc(5): 22 is the start, in ticks since boot
    fields >> field;
  timespec boot{}, now{};
  if (!fields || ::clock_gettime(CLOCK_BOOTTIME, &boot) != 0 ||
      ::clock_gettime(CLOCK_REALTIME, &now) != 0)
    return std::nullopt;
  return static_cast<double>(now.tv_sec - boot.tv_sec) +
         std::stod(field) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// Whether a process lives that can have written the file: its number may be taken again.
bool still_written(pid_t process, const fs::path &file) {
  if (::kill(process, 0) != 0 && errno == ESRCH) return false;
  struct stat facts {};
  if (::stat(file.c_str(), &facts) != 0) return true;
  constexpr double slack = 2; // of the clocks
  const std::optional<double> beginning = beginning_of(process);
  return !beginning || *beginning <= static_cast<double>(facts.st_mtime) + slack;
}

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

void write_directly(const fs::path &path, const std::string &bytes) {
  Output out(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (out.get() < 0 || !write_all(out.get(), bytes) || out.close() != 0)
    throw cannot_write(path.string());
}

/// Makes a new, empty file beside `path`; processes that write at the same time get different ones.
fs::path make_temporary(const fs::path &path) {
  fs::path name;
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
fs::path target_of(const fs::path &path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (fs::is_directory(status))
    throw failure("cannot write " + path.string() + ": it is a directory");
  if (!fs::exists(status)) return path;
  const fs::path target = fs::canonical(path, error);
  if (error) throw failure("cannot write " + path.string() + ": " + error.message());
  return target;
}

/// Makes a file durable where its file system can: those of some networks cannot.
bool synced(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP;
}

/// Gives a new file the mode of the one that it replaces, where its file system has modes.
void keep_mode(int descriptor, const fs::path &before) {
  struct stat facts {};
  if (::stat(before.c_str(), &facts) == 0 && ::fchmod(descriptor, facts.st_mode & 07777U) != 0)
    errno = 0;
}

/// Makes the new name durable. Some file systems cannot: the file itself is complete already.
void sync_directory(const fs::path &path) {
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const int directory = ::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory < 0) return;
  (void)::fsync(directory);
  ::close(directory);
}

/// Files that are not there yet are compared by their names.
bool same_file(const std::filesystem::path &a, const std::filesystem::path &b) {
  std::error_code error;
  if (std::filesystem::equivalent(a, b, error)) return true;
  const auto first = std::filesystem::weakly_canonical(std::filesystem::absolute(a), error);
  if (error) return false;
  const auto second = std::filesystem::weakly_canonical(std::filesystem::absolute(b), error);
  return !error && first == second;
}

} // namespace

fs::path temporary_name(const fs::path &path, int attempt) {
  fs::path name = path;
  name += mark + host_mark() + "." + std::to_string(::getpid()) + "." + std::to_string(attempt);
  return name;
}

void remove_stale_temporaries(const fs::path &directory, const std::string &of) {
  std::error_code error;
  std::vector<fs::path> stale;
  for (const auto &entry : fs::directory_iterator(directory, error)) {
    const std::string name = entry.path().filename().string();
    const std::optional<pid_t> process = writer_of(name);
    const bool wanted = of.empty() || name.substr(0, name.rfind(mark)) == of;
    if (wanted && process && !still_written(*process, entry.path())) stale.push_back(entry.path());
  }
  for (const fs::path &file : stale)
    fs::remove(file, error);
}

bool stop_writing(std::chrono::milliseconds patience) {
  std::unique_lock lock(writing.mutex);
  writing.stopped = true;
  return writing.changed.wait_for(lock, patience, [] { return writing.files == 0; });
}

void make_directory(const fs::path &path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw failure("cannot make the directory " + path.string() + ": " + error.message());
}

AtomicFile::AtomicFile(const fs::path &path) : target_(target_of(path)) {
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

void write_atomically(const fs::path &path, const std::string &bytes) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_directory(status) && !fs::is_regular_file(status))
    return write_directly(path, bytes);
  AtomicFile file(path);
  file.append(bytes);
  file.commit();
}

void check_overwriting(const NamedFile &output, const std::vector<NamedFile> &inputs) {
  if (output.path.empty()) return;
  for (const NamedFile &input : inputs)
    if (!input.path.empty() && same_file(output.path, input.path))
      throw bad_input(output.what + " " + output.path.string() + " would overwrite " + input.what +
                      " " + input.path.string() + ": name another file");
}

} // namespace rbvi
