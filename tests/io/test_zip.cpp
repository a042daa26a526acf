// Archives have the places and checksums that the format of ZIP prescribes.
#include "rbvi/io/zip.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace rbvi::zip_test {
namespace {

std::uint64_t number(const std::string &archive, std::size_t at, std::size_t bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    value |= std::uint64_t{static_cast<unsigned char>(archive[at + i])} << 8 * i;
  return value;
}

TEST(Zip, ListsItsFiles) {
  const std::vector<ZippedFile> files{
      {"check", "123456789"}, {"a/folder/empty", ""}, {"b", std::string(1, '\0')}};
  const std::string archive = zip_of(files);
  const std::size_t end = archive.size() - 22;
  ASSERT_EQ(number(archive, end, 4), 0x06054b50U);
  EXPECT_EQ(number(archive, end + 8, 2), files.size());
  EXPECT_EQ(number(archive, end + 10, 2), files.size());
  std::size_t at = number(archive, end + 16, 4);
  EXPECT_EQ(at + number(archive, end + 12, 4), end);
  for (const auto &[name, bytes] : files) {
    ASSERT_EQ(number(archive, at, 4), 0x02014b50U) << name;
    EXPECT_EQ(archive.substr(at + 46, number(archive, at + 28, 2)), name);
    EXPECT_EQ(number(archive, at + 20, 4), bytes.size());
    EXPECT_EQ(number(archive, at + 24, 4), bytes.size());
    const std::size_t own = number(archive, at + 42, 4);
    ASSERT_EQ(number(archive, own, 4), 0x04034b50U) << name;
    EXPECT_EQ(archive.substr(own + 4, 26), archive.substr(at + 6, 26))
        << "the same facts in both places";
    EXPECT_EQ(archive.substr(own + 30, name.size() + bytes.size()), name + bytes);
    at += 46 + name.size();
  }
  EXPECT_EQ(at, end);
}

TEST(Zip, HasTheChecksumOfTheStandard) {
  EXPECT_EQ(number(zip_of({{"check", "123456789"}}), 14, 4), 0xcbf43926U);
}

} // namespace
} // namespace rbvi::zip_test
