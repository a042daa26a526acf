#include "rbvi/io/system_error.hpp"
#include "rbvi/io/write_atomically.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <fstream>
#include <thread>

namespace {
int error_of_fsync = 0;
} // namespace

/// In place of the system's: fails as some file systems do.
extern "C" int fsync(int) {
  errno = error_of_fsync;
  return error_of_fsync == 0 ? 0 : -1;
}

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

/// Whether no file is being written any more, asked in a process that then ends.
bool stop_writing_in_a_child() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(stop_writing(std::chrono::milliseconds(10)) ? 0 : 1);
  int status = -1;
  ::waitpid(child, &status, 0);
  return status == 0;
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

TEST_F(TemporaryFiles, OfOneFileAlone) {
  const fs::path stale = touch(name_of(ended_process()));
  remove_stale_temporaries(directory, "b.h5");
  EXPECT_TRUE(fs::exists(stale));
  remove_stale_temporaries(directory, "a.h5");
  EXPECT_FALSE(fs::exists(stale));
}

TEST_F(TemporaryFiles, StayWhereTheyAreLeft) {
  fs::path left;
  {
    AtomicFile file(directory / "a.csv");
    file.append("rows");
    left = file.temporary();
    file.leave();
  }
  EXPECT_TRUE(fs::exists(left));
  EXPECT_FALSE(fs::exists(directory / "a.csv"));
  EXPECT_TRUE(stop_writing_in_a_child());
}

TEST_F(TemporaryFiles, AReplacedFileKeepsItsMode) {
  const fs::path path = touch("a.csv");
  for (const fs::perms mode : {fs::perms::owner_read | fs::perms::owner_write,
                               fs::perms::owner_all | fs::perms::group_read}) {
    fs::permissions(path, mode);
    write_atomically(path, "new");
    EXPECT_EQ(fs::status(path).permissions(), mode);
  }
}

/// What a file system cannot do is no failure; what it fails at is one, with its reason.
TEST_F(TemporaryFiles, AFileSystemWithoutFsyncIsWrittenTo) {
  for (const int unknown : {EINVAL, ENOSYS, EOPNOTSUPP}) {
    error_of_fsync = unknown;
    EXPECT_NO_THROW(write_atomically(directory / std::to_string(unknown), "x"));
  }
  error_of_fsync = EIO;
  std::string message;
  try {
    write_atomically(directory / "lost", "x");
  } catch (const Error &error) {
    message = error.what();
  }
  error_of_fsync = 0;
  EXPECT_NE(message.find("Input/output error"), std::string::npos) << message;
  EXPECT_FALSE(fs::exists(directory / "lost"));
}

TEST(InPlainWords, WantOfMemory) {
  const std::string said = in_plain_words("std::bad_alloc, while solving radius=1");
  EXPECT_TRUE(said.starts_with("out of memory, while solving radius=1; try a coarser mesh"))
      << said;
  EXPECT_EQ(in_plain_words("another failure"), "another failure");
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
