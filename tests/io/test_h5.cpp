#include "rbvi/core/error.hpp"
#include "rbvi/io/checksum.hpp"
#include "rbvi/io/h5.hpp"
#include "rbvi/io/write_atomically.hpp"

#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <limits>
#include <sstream>
#include <sys/resource.h>

namespace rbvi::h5_test {
namespace {

using Path = std::filesystem::path;

struct SealedFile : testing::Test {
  Path directory = Path(testing::TempDir()) / ("rbvi_h5_" + std::to_string(::getpid()));
  Path path = directory / "a.h5";
  void SetUp() override { std::filesystem::create_directories(directory); }
  void TearDown() override { std::filesystem::remove_all(directory); }

  std::size_t files() const {
    const std::filesystem::directory_iterator begin(directory), end;
    return static_cast<std::size_t>(std::distance(begin, end));
  }
};

std::string slurp(const Path &path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

void spill(const Path &path, const std::string &bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The message of the bad_input that opening throws; fails if it does not throw one.
std::string complaint(const Path &path, const std::string &kind = "sample", int schema = 3) {
  try {
    const H5Reader reader(path, kind, schema);
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  ADD_FAILURE() << path << " was accepted";
  return "";
}

void commit_small(const Path &path) {
  H5Writer writer;
  writer.write("group/u", std::vector<double>{1.5, -2.5});
  writer.commit(path, "sample", 3);
}

bool contains(const std::string &text, const std::string &part) {
  return text.find(part) != std::string::npos;
}

TEST_F(SealedFile, ReturnsWhatWasWritten) {
  Matrix matrix(2, 3);
  matrix << 1, 2, 3, 4, 5, -1.0 / 3;
  const Vector vector = Vector::LinSpaced(4, 0, std::numeric_limits<double>::min());
  const std::vector<std::string> texts{"", "two words", "\xc3\xa9"};
  H5Writer writer;
  writer.write("m", matrix);
  writer.write("deep/er/v", vector);
  writer.write("deep/d", std::vector<double>{});
  writer.write("none", Matrix(0, 5));
  writer.write("i", std::vector<int>{7, -7});
  writer.write("s", texts);
  writer.write("no_s", std::vector<std::string>{});
  writer.write("text", std::string("solve"));
  writer.write("empty", std::string());
  writer.write("x", 0.1);
  writer.write("n", 42);
  writer.commit(path, "sample", 3);

  const H5Reader reader(path, "sample", 3);
  EXPECT_EQ(reader.read<Matrix>("m"), matrix);
  EXPECT_EQ(reader.read<Vector>("deep/er/v"), vector);
  EXPECT_TRUE(reader.read<std::vector<double>>("deep/d").empty());
  EXPECT_EQ(reader.read<Matrix>("none").rows(), 0);
  EXPECT_EQ(reader.read<Matrix>("none").cols(), 5);
  EXPECT_EQ(reader.read<std::vector<int>>("i"), (std::vector<int>{7, -7}));
  EXPECT_EQ(reader.read<std::vector<std::string>>("s"), texts);
  EXPECT_TRUE(reader.read<std::vector<std::string>>("no_s").empty());
  EXPECT_EQ(reader.read<std::string>("text"), "solve");
  EXPECT_EQ(reader.read<std::string>("empty"), "");
  EXPECT_EQ(reader.read<double>("x"), 0.1);
  EXPECT_EQ(reader.read<int>("n"), 42);
  EXPECT_TRUE(reader.has("deep/er"));
  EXPECT_FALSE(reader.has("deep/no/v"));
}

TEST_F(SealedFile, MatricesOfMostlyZerosAreSmall) {
  Matrix sparse = Matrix::Zero(700, 900);
  for (Index i = 0; i < sparse.rows(); ++i)
    sparse(i, (7 * i) % sparse.cols()) = 1.0 / static_cast<double>(i + 1);
  H5Writer writer;
  writer.write("sparse", sparse);
  writer.commit(path, "sample", 3);
  EXPECT_EQ(H5Reader(path, "sample", 3).read<Matrix>("sparse"), sparse);
  EXPECT_LT(std::filesystem::file_size(path), 200000U);
}

TEST_F(SealedFile, SeveralAreOpenAtOnceAndMove) {
  H5Writer one, two;
  one.write("x", 1.0);
  two.write("x", 2.0);
  H5Writer moved = std::move(one);
  moved.commit(path, "sample", 3);
  two.commit(directory / "b.h5", "sample", 3);
  H5Reader a(path, "sample", 3), b(directory / "b.h5", "sample", 3);
  EXPECT_EQ(b.read<double>("x"), 2.0);
  b = std::move(a);
  EXPECT_EQ(b.read<double>("x"), 1.0);
}

TEST_F(SealedFile, OnTheDiskIsTheSameAsInMemory) {
  const Matrix matrix = Matrix::Random(7, 3);
  H5Writer disk(path);
  disk.write("x", 0.1);
  disk.create_rows("deep/m", 7, 3);
  for (const auto &[first, count] : {std::pair<Index, Index>{4, 3}, {0, 3}, {3, 1}})
    disk.write_rows("deep/m", first, matrix.middleRows(first, count));
  EXPECT_FALSE(std::filesystem::exists(path));
  disk.commit(path, "sample", 3);
  const H5Reader reader(path, "sample", 3);
  EXPECT_EQ(reader.read<Matrix>("deep/m"), matrix);
  EXPECT_EQ(reader.read<double>("x"), 0.1);
  EXPECT_EQ(files(), 1U);
}

TEST_F(SealedFile, OneThatIsNotCommittedLeavesNothing) {
  commit_small(path);
  const std::string before = slurp(path);
  {
    H5Writer disk(path);
    disk.create_rows("m", 1000, 10);
    disk.write_rows("m", 0, Matrix::Ones(500, 10));
    EXPECT_THROW(disk.write_rows("m", 900, Matrix::Ones(200, 10)), Error);
    EXPECT_THROW(disk.create_rows("m", 2, 2), Error);
  }
  EXPECT_EQ(slurp(path), before);
  EXPECT_EQ(files(), 1U);
}

TEST_F(SealedFile, BytesDependOnContentAlone) {
  commit_small(path);
  commit_small(directory / "b.h5");
  EXPECT_EQ(slurp(path), slurp(directory / "b.h5"));
}

TEST_F(SealedFile, PlainHdf5ReadsIt) {
  commit_small(path);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t set = H5Dopen2(file, "group/u", H5P_DEFAULT);
  double values[2] = {0, 0};
  EXPECT_GE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0);
  EXPECT_EQ(values[1], -2.5);
  const hid_t properties = H5Fget_create_plist(file);
  hsize_t block = 0;
  H5Pget_userblock(properties, &block);
  EXPECT_EQ(block, 512U);
  H5Pclose(properties);
  H5Dclose(set);
  H5Fclose(file);
}

TEST_F(SealedFile, DataSetsAreChecked) {
  H5Writer writer;
  writer.write("x", 1.0);
  EXPECT_THROW(writer.write("x", 2.0), Error);
  writer.write("v", std::vector<double>{1, 2});
  writer.commit(path, "sample", 3);
  const H5Reader reader(path, "sample", 3);
  EXPECT_THROW(reader.read<double>("y"), Error);
  EXPECT_THROW(reader.read<double>("v"), Error);
  EXPECT_THROW(reader.read<Matrix>("v"), Error);
  EXPECT_THROW(reader.read<std::vector<int>>("v"), Error);
  EXPECT_THROW(reader.read<std::string>("x"), Error);
}

TEST_F(SealedFile, EveryFlippedBitIsNoticed) {
  commit_small(path);
  const std::string good = slurp(path);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    spill(path, bad);
    const std::string expected = i < 8 ? "not an rbvi file" : "damaged";
    ASSERT_TRUE(contains(complaint(path), expected)) << "byte " << i << ": " << complaint(path);
  }
}

TEST_F(SealedFile, EveryTruncationIsNoticed) {
  commit_small(path);
  const std::string good = slurp(path);
  for (std::size_t size = 1; size < good.size(); size += 13) {
    spill(path, good.substr(0, size));
    ASSERT_TRUE(contains(complaint(path), "truncated")) << size;
  }
  spill(path, "");
  EXPECT_TRUE(contains(complaint(path), "empty"));
  spill(path, good + "x");
  EXPECT_TRUE(contains(complaint(path), "damaged"));
}

TEST_F(SealedFile, ForeignFilesAreNamed) {
  EXPECT_TRUE(contains(complaint(directory / "no.h5"), "does not exist"));
  EXPECT_TRUE(contains(complaint(directory), "directory"));
  spill(path, "radius,center_x\n0.2,0\n");
  EXPECT_TRUE(contains(complaint(path), "not an rbvi file"));
  const Path plain = directory / "plain.h5";
  H5Fclose(H5Fcreate(plain.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_TRUE(contains(complaint(plain), "HDF5 file, but not one written by rbvi"));
  commit_small(path);
  EXPECT_TRUE(contains(complaint(path, "model"), "is a sample file, not a model file"));
  EXPECT_TRUE(contains(complaint(path, "sample", 4), "schema version 3"));
}

TEST_F(SealedFile, FailedWritesLeaveNothing) {
  commit_small(path);
  const std::string before = slurp(path);
  EXPECT_THROW(write_atomically(path / "below_a_file.h5", "x"), Error);
  EXPECT_THROW(write_atomically(directory / "missing" / "a.h5", "x"), Error);
  EXPECT_THROW(write_atomically(directory, "x"), Error);
  EXPECT_THROW(write_atomically("/dev/full", "x"), Error);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));

  // A full disk, as the limit on the size of a file.
  struct rlimit limit {
  }, small{};
  getrlimit(RLIMIT_FSIZE, &limit);
  small = {1000, limit.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write_atomically(path, std::string(5000, 'x')), Error);
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);

  EXPECT_EQ(slurp(path), before);
  EXPECT_EQ(files(), 1U);
}

/// A large file, which is on the disk while it is written; the program ends by itself.
TEST_F(SealedFile, AFullDiskIsNoCrashAtTheEnd) {
  const auto fills = [&] {
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{};
    ::getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = 100000;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      H5Writer writer(path);
      for (const char *name : {"a", "b", "c"})
        writer.write(name, Matrix(Matrix::Random(200, 200)));
      writer.commit(path, "sample", 3);
    } catch (const Error &) {
      std::exit(3);
    }
  };
  EXPECT_EXIT(fills(), testing::ExitedWithCode(3), "");
}

TEST_F(SealedFile, WritingReplacesAndFollowsLinks) {
  spill(path, "old");
  std::filesystem::create_symlink(path, directory / "link");
  write_atomically(directory / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(directory / "link"));
  EXPECT_EQ(slurp(path), "new");
  EXPECT_EQ(files(), 2U);
}

TEST(Fnv1a, PublishedValues) {
  // Test vectors of the authors (Fowler, Noll, Vo).
  EXPECT_EQ(fnv1a("", 0), 0xcbf29ce484222325ULL);
  EXPECT_EQ(fnv1a("a", 1), 0xaf63dc4c8601ec8cULL);
  EXPECT_EQ(fnv1a("foobar", 6), 0x85944171f73967e8ULL);
}

} // namespace
} // namespace rbvi::h5_test
