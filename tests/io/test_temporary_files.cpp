#include "rbvi/io/temporary_files.hpp"
#include "rbvi/io/write_atomically.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

namespace rbvi::temporary_files_test {
namespace {

namespace fs = std::filesystem;

struct TemporaryFiles : testing::Test {
  fs::path directory = fs::path(testing::TempDir()) / ("rbvi_tmp_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(directory); }
  void TearDown() override { fs::remove_all(directory); }
  fs::path touch(const std::string &name) const {
    std::ofstream(directory / name) << "half a file";
    return directory / name;
  }
};

std::string dotted(pid_t process) {
  return std::string(".") + std::to_string(process) + ".";
}

/// As another process calls its file.
std::string name_of(pid_t process) {
  std::string name = temporary_name("a.h5", 3).string();
  const std::string own = dotted(::getpid());
  return name.replace(name.rfind(own), own.size(), dotted(process));
}

pid_t ended_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST_F(TemporaryFiles, OfEndedProcessesAreRemoved) {
  const fs::path stale = touch(name_of(ended_process()));
  remove_stale_temporaries(directory);
  EXPECT_FALSE(fs::exists(stale));
}

TEST_F(TemporaryFiles, OfALiveProcessStay) {
  const fs::path own = touch(temporary_name("a.h5", 0).string()), other = touch(name_of(getppid()));
  remove_stale_temporaries(directory);
  EXPECT_TRUE(fs::exists(own));
  EXPECT_TRUE(fs::exists(other));
}

TEST_F(TemporaryFiles, OlderThanTheProcessOfTheirNumberAreRemoved) {
  const fs::path stale = touch(temporary_name("a.h5", 0).string());
  fs::last_write_time(stale, fs::file_time_type::clock::now() - std::chrono::hours(24 * 365 * 20));
  remove_stale_temporaries(directory);
  EXPECT_FALSE(fs::exists(stale));
}

TEST_F(TemporaryFiles, OtherNamesStay) {
  const std::string dead = std::to_string(ended_process());
  const std::string other_host = "a.h5.tmp.zzzzzzzz." + dead + ".0";
  const std::string stale = name_of(ended_process());
  const std::vector<std::string> names{
      "a.h5", "a.h5.tmp." + dead + ".0", other_host, "notes.tmp", stale + ".csv", "a.h5.tmp.1.2.x"};
  for (const std::string &name : names)
    touch(name);
  remove_stale_temporaries(directory);
  for (const std::string &name : names)
    EXPECT_TRUE(fs::exists(directory / name)) << name;
  remove_stale_temporaries(directory / "missing");
  EXPECT_FALSE(fs::exists(directory / "missing"));
}

TEST_F(TemporaryFiles, AProcessThatStopsWritingBeginsNoFile) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::thread([] {
      if (!stop_writing(std::chrono::milliseconds(100))) ::_exit(2);
    }).join();
    write_atomically(directory / "late", "x"); // waits for ever
    ::_exit(1);
  }
  ::usleep(300000);
  EXPECT_EQ(::waitpid(child, nullptr, WNOHANG), 0);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::is_empty(directory));
}

} // namespace
} // namespace rbvi::temporary_files_test
