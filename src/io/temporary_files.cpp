#include "rbvi/io/temporary_files.hpp"

#include "rbvi/core/parameters.hpp"
#include "rbvi/io/checksum.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <optional>
#include <sstream>
#include <unistd.h>

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

} // namespace rbvi
